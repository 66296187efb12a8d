// The program as it is installed: into a prefix that is moved afterwards, with nothing of the checkout in reach.
#include <doctest/doctest.h>

#include <algorithm>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;
namespace fs = std::filesystem;

namespace {

fs::path const root = SYSID_SOURCE_DIR;

/// A prefix with the program in it, moved once.
class Prefix {
 public:
  Prefix() {
    fs::path const first = folder_.path() / "first";
    installed_ = said_by("cmake --install '" SYSID_BUILD_DIR "' --component program --prefix '" + first.string() + "'");
    REQUIRE_MESSAGE(installed_.exit == 0, installed_.text);
    fs::rename(first, path());
  }
  fs::path path() const { return folder_.path() / "moved" / ""; }
  /// A command in FOLDER, with the moved program first on the path and an environment of nothing else.
  Said ask(fs::path const& folder, std::string const& command) const {
    return said_by("cd '" + folder.string() + "' && env -i PATH='" + (path() / "bin").string() + ":/usr/bin:/bin' " + command);
  }

 private:
  TemporaryFolder folder_;
  Said installed_;
};

/// Files of a folder of results by their path in it, but for how long it took.
std::vector<std::pair<std::string, std::string>> results_in(fs::path const& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  for (auto const& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename() != "timing.json")
      files.emplace_back(entry.path().lexically_relative(folder).string(), read_file(entry.path()));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

TEST_CASE("a moved prefix runs a copied case to the bytes of the checkout, machine code included") {
  Prefix const prefix;
  Desk const desk;
  for (char const* name : {"duffing.sysid", "duffing_1pct.csv"}) fs::copy_file(root / "models/duffing" / name, desk.path(name));
  Said const here = desk.ask("run duffing.sysid --quiet --executor native");
  CHECK_MESSAGE(here.exit == 0, here.text);
  fs::rename(desk.path("results"), desk.path("of_checkout"));
  Said const there = prefix.ask(desk.path(""), "sysid run duffing.sysid --quiet --executor native");
  CHECK_MESSAGE(there.exit == 0, there.text);
  CHECK(there.text == here.text);
  auto const expected = results_in(desk.path("of_checkout")), found = results_in(desk.path("results"));
  CHECK(expected.size() > 20);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].first == expected[i].first);
    CHECK_MESSAGE(found[i].second == expected[i].second, found[i].first << " differs");
  }
}

TEST_CASE("a moved prefix has modules of the language, pages of messages, a manual and completions") {
  Prefix const prefix;
  Desk const desk;
  CHECK(prefix.ask(desk.path(""), "sysid explain E2103").text.starts_with("E2103"));
  CHECK(prefix.ask(desk.path(""), "sysid document hysteresis").exit == 0);
  fs::path const share = prefix.path() / "share";
  for (char const* name :
       {"man/man1/sysid.1.gz", "man/man1/sysid-fit.1.gz", "bash-completion/completions/sysid", "zsh/vendor-completions/_sysid",
        "fish/vendor_completions.d/sysid.fish", "doc/sysid/docs/tutorial.md", "doc/sysid/docs/errors/E2-names.md",
        "doc/sysid/stdlib/hysteresis.sysid", "doc/sysid/models/duffing/duffing.sysid"})
    CHECK_MESSAGE(fs::exists(share / name), name);
  Said const page = prefix.ask(desk.path(""), "gzip -dc '" + (share / "man/man1/sysid-fit.1.gz").string() + "'");
  CHECK(page.text == desk.ask("manual fit").text);
}
