// No decision hangs on the wording of a message: with other sentences the same errors remain, at the same places.
#include <doctest/doctest.h>

#include <algorithm>
#include <regex>
#include <tuple>
#include <vector>

#include "app/answer.hpp"
#include "load/load.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

struct Told {
  Severity severity;
  std::string code;
  std::uint32_t begin, end;
  bool operator==(Told const&) const = default;
};

/// What is told of a text; words: what is done to every message first.
std::vector<Told> told_of(std::filesystem::path const& path, std::function<void(Diagnostic&)> words) {
  Source source(path.filename().string(), content(path));
  Diagnostics diagnostics;
  diagnostics.reword(std::move(words));
  load(source, diagnostics);
  std::vector<Told> told;
  for (Diagnostic const& each : diagnostics.all())
    told.push_back(
        {each.severity, each.code, each.primary ? each.primary->span.begin : 0, each.primary ? each.primary->span.end : 0});
  return told;
}

}  // namespace

TEST_CASE("with other sentences in every message the same errors remain at the same places") {
  WorkingFolder const here(error_examples);
  int several = 0;
  for (auto const& entry : std::filesystem::directory_iterator(error_examples)) {
    if (entry.path().extension() != ".sysid") continue;
    CAPTURE(entry.path().string());
    std::vector<Told> const plain = told_of(entry.path(), {});
    CHECK(told_of(entry.path(), [](Diagnostic& each) { each.message = each.help = "reworded"; }) == plain);
    CHECK(told_of(entry.path(), [](Diagnostic& each) { each.message.clear(), each.help.clear(); }) == plain);
    several += plain.size() > 1 ? 1 : 0;
  }
  CHECK(several > 0);
}

TEST_CASE("no source decides by the text of a message or of its help") {
  std::regex const decision("(\\.|->)(message|help)(\\.(find|rfind|starts_with|ends_with|contains|compare|substr)|\\s*[!=]=)");
  for (char const* folder : {"grammar", "src"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
      std::string const text = content(entry.path());
      std::smatch found;
      CHECK_MESSAGE(!std::regex_search(text, found, decision), entry.path().string() << ": " << found.str());
    }
}
