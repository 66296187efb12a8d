// A small number is compared by a tolerance that it can fail: doctest's is absolute below a size of 1 (tests/relative.hpp).
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/system/files.hpp"

namespace {

std::string const approximate_of = std::string("App") + "rox(";  // this file names none of its own

/// Behind the bracket that closes the one which opens at `open`.
std::size_t behind_bracket(std::string const& text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
    if (depth == 0) return i + 1;
  }
  return text.size();
}

/// The small numbers, written as such, that are compared without saying of what scale they are.
std::vector<std::string> small_without_scale(std::string const& text) {
  constexpr double small = 0.3;
  std::vector<std::string> found;
  for (std::size_t at = text.find(approximate_of); at != std::string::npos; at = text.find(approximate_of, at + 1)) {
    std::size_t const open = at + approximate_of.size() - 1;
    std::string const argument = text.substr(open + 1, behind_bracket(text, open) - open - 2);
    char* end = nullptr;
    double const value = std::strtod(argument.c_str(), &end);
    if (argument.empty() || *end != '\0' || value == 0 || std::abs(value) >= small) continue;
    bool scaled = false;
    for (std::size_t next = text.find_first_not_of(" \n", behind_bracket(text, open));
         next != std::string::npos && text[next] == '.';) {
      scaled = scaled || text.compare(next, 7, ".scale(") == 0;
      std::size_t const call = text.find('(', next);
      if (call == std::string::npos) break;
      next = text.find_first_not_of(" \n", behind_bracket(text, call));
    }
    if (!scaled) found.push_back(argument);
  }
  return found;
}

}  // namespace

TEST_CASE("a small number has a tolerance that it can fail") {
  std::filesystem::path const root = SYSID_SOURCE_DIR;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(root / "tests")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    for (std::string const& number : small_without_scale(sysid::read_file(entry.path()))) {
      FAIL_CHECK(entry.path().lexically_relative(root).string()
                 << " compares with " << number << " to an absolute tolerance: write relative(value, tolerance)");
    }
  }
  std::string const tried = approximate_of + "0.01).epsilon(0.2)); " + approximate_of + "-2e-6)); " + approximate_of +
                            "1e-3)\n  .epsilon(0.1)\n  .scale(0)); " + approximate_of + "0.01).scale(1)); " + approximate_of +
                            "0.5).epsilon(0.1)); " + approximate_of + "0)); " + approximate_of + "x)); " + approximate_of +
                            "1e-3 * x).epsilon(f(2)));";
  CHECK(small_without_scale(tried) == std::vector<std::string>{"0.01", "-2e-6"});
}
