// Every message behind the syntax stage: the bad examples of tests/golden/errors (E2 to E6) with what is shown for them.
// SYSID_BLESS=1 in the environment rewrites the expected texts; review the difference.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <regex>
#include <set>

#include "answer.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::vector<std::filesystem::path> examples() {
  std::vector<std::filesystem::path> out;
  for (auto const& entry : std::filesystem::directory_iterator(error_examples))
    if (std::string const name = entry.path().filename().string();
        entry.path().extension() == ".sysid" && name.starts_with("E") && !name.starts_with("E1"))
      out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

// What is only warned of; all else is refused.
bool is_warning(std::string const& name) {
  return name.starts_with("E212") || name.starts_with("E2210") || name.starts_with("E2213") || name.starts_with("E2214") || name.starts_with("E3019") || name.starts_with("E3021") || name.starts_with("E3114") ||
         name.starts_with("E6019") || name.starts_with("E6020");
}

std::string expected_for(std::filesystem::path example) { return content(example.replace_extension(".expected")); }

// Codes as the sources name them in quotes, with the files that do.
std::set<std::string> codes_in_sources() {
  std::set<std::string> codes;
  std::regex const code("\"(E[2-6][0-9]{3})\"");
  for (char const* folder : {"src/check", "src/data", "src/app", "src/distribution", "src/experiment", "src/load"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      std::string const text = content(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), code), end; match != end; ++match) codes.insert((*match)[1]);
    }
  return codes;
}

}  // namespace

TEST_CASE("each bad example is answered by the expected messages and exit code") {
  bool const bless = std::getenv("SYSID_BLESS") != nullptr;
  WorkingFolder const here(error_examples);
  for (std::filesystem::path const& path : examples()) {
    CAPTURE(path.string());
    TemporaryFolder const output;
    bool const warning = is_warning(path.filename().string());
    Answer const shown = answer(path.filename().string(), content(path), warning ? Depth::data : Depth::run, output.path());
    std::filesystem::path expected = path;
    expected.replace_extension(".expected");
    if (bless) write(expected, shown.messages);
    CHECK(shown.messages == content(expected));
    bool const unreadable = path.filename().string().starts_with("E4018");
    ExitCode const refused = unreadable ? ExitCode::io : ExitCode::user_error;
    CHECK(shown.exit == (warning ? ExitCode::success : refused));
  }
}

TEST_CASE("one mistake gives one message, of the code in the example's name, with a place and something to do") {
  for (std::filesystem::path const& path : examples()) {
    CAPTURE(path.string());
    std::string const name = path.filename().string(), shown = expected_for(path);
    if (name.find("several") != std::string::npos) {
      CHECK(count(shown, "error[") > 1);
      continue;
    }
    CHECK(count(shown, "error[") + count(shown, "warning[") == 1);
    CHECK(count(shown, (is_warning(name) ? "warning[" : "error[") + name.substr(0, 5) + "]") == 1);
    // A mistake in a module is shown there: beside_e2904_laws.sysid.
    std::string beside = "beside_" + name.substr(0, 5);
    beside[7] = 'e';
    CHECK((shown.starts_with(name + ":") || shown.starts_with(beside)));
    CHECK(count(shown, "\n     | ") >= 1);
    CHECK(count(shown, "\nhelp: ") == 1);
  }
}

TEST_CASE("every code of the sources has an example") {
  // Stored results cannot be text: their messages are in stored_results.cpp. E2109, E2114 and E6206 guard what later
  // distributions and back ends may do. E4020 and E5003 are of records larger than a test has, see tests/cli/faults.cpp. E6211
  // needs a fit: tests/app/task/improper.cpp; E6212 a caller who wants a function: tests/app/density/fit_density.cpp;
  // E6213 to E6215 several processes: tests/cli/ranks.cpp.
  std::set<std::string> const elsewhere = {"E2109", "E2114", "E4020", "E5003", "E6201", "E6202", "E6206", "E6207",
                                           "E6208", "E6209", "E6210", "E6211", "E6212", "E6213", "E6214", "E6215"};
  std::set<std::string> shown;
  for (std::filesystem::path const& path : examples()) shown.insert(path.filename().string().substr(0, 5));
  std::set<std::string> const codes = codes_in_sources();
  CHECK(codes.size() > 90);
  for (std::string const& code : codes)
    if (!elsewhere.contains(code)) CHECK_MESSAGE(shown.contains(code), code);
  for (std::string const& code : elsewhere) CHECK_MESSAGE(!shown.contains(code), code);
}
