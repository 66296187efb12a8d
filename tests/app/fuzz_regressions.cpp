// What the fuzzers once found, and every golden example, model and table, through the same stages as in the fuzzers.
#include <doctest/doctest.h>

#include "answer.hpp"
#include "fuzz/stages.hpp"

using namespace sysid;

namespace {

std::vector<std::string> contents(std::string const& folder, std::string const& extension) {
  std::vector<std::string> out;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder))
    if (entry.is_regular_file() && (extension.empty() || entry.path().extension() == extension))
      out.push_back(test::content(entry.path()));
  return out;
}

}  // namespace

TEST_CASE("texts that once were a fault are answered, and so are all examples") {
  for (char const* folder : {"tests/fuzz/regressions/text", "tests/golden/errors", "models"})
    for (std::string const& text : contents(folder, std::string(folder).starts_with("tests/fuzz") ? "" : ".sysid")) {
      INFO(text);
      CHECK_NOTHROW(fuzz::text(text));
    }
}

TEST_CASE("data that once were a fault are answered, and so are all examples") {
  for (std::string const& bytes : contents("tests/fuzz/regressions/data", "")) CHECK_NOTHROW(fuzz::data(bytes));
  for (std::string const& bytes : contents("tests/golden/errors/data", ".csv"))
    for (char const rule : {'0', '1', '2', '3', '4', '7'}) CHECK_NOTHROW(fuzz::data(rule + bytes));
}
