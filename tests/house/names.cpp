// No name of a type stands for two things: a linker takes one of two destructors of the same name for both, without a word.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include "core/system/files.hpp"

namespace {

/// The types that a header defines at its outermost level, each with its namespace before it.
std::vector<std::string> types_of(std::string const& header) {
  static std::regex const begins(R"(^namespace ([a-z_:]+) \{)"),
      defines(R"(^(?:struct|class|enum class) (\w+)(?: final)?(?: :.*)? \{)");
  std::vector<std::string> found;
  std::string within;
  std::istringstream text(header);
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_search(line, match, begins)) within = match[1];
    if (line.starts_with("}  // namespace")) within.clear();
    if (std::regex_search(line, match, defines)) found.push_back(within + "::" + match[1].str());
  }
  return found;
}

}  // namespace

TEST_CASE("types of two headers have two names") {
  std::filesystem::path const root = SYSID_SOURCE_DIR;
  std::map<std::string, std::string> seen;
  for (char const* folder : {"src", "grammar"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      std::string const path = entry.path().lexically_relative(root).string();
      // What callers of the library see is compiled by them, and by nothing here.
      if (entry.path().extension() != ".hpp" || path.starts_with("src/library/")) continue;
      for (std::string const& name : types_of(sysid::read_file(entry.path()))) {
        auto const [place, is_new] = seen.emplace(name, path);
        CHECK_MESSAGE(is_new, name << " is in " << place->second << " and in " << path);
      }
    }
  CHECK(seen.size() > 400);
  CHECK(types_of("namespace a::b {\nstruct One {\n};\n  struct Within {\n}  // namespace a::b\nclass Two : public One {\n") ==
        std::vector<std::string>{"a::b::One", "::Two"});
}
