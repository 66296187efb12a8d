// What a discovery writes above the model that it found.
#include "discovery/found_source.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("the verdict of a discovery and its warnings are comments above the model, each on a line of its own") {
  Findings const findings = {{FindingCode::form_undecided, Severity::warning, {}, "two structures\nare as probable", "more"},
                             {FindingCode::terms_repeat, Severity::note, {}, "a term repeats another", ""},
                             {FindingCode::too_few_rows, Severity::error, {}, "too few rows", ""}};
  std::string const source = "# found.sysid\n# second line\n\nmodel found {\n}\n";
  std::string const head =
      "# found.sysid\n# second line\n#\n# verdict of the discovery: undecided between two equations\n"
      "# warning[" +
      std::string(word(FindingCode::form_undecided)) +
      "]: two structures are as probable\n"
      "# error[too_few_rows]: too few rows\n";
  CHECK(with_verdict(source, "undecided\nbetween two equations", findings) == head + "\nmodel found {\n}\n");
  CHECK(with_verdict("model found {\n}\n", "found", {}) == "#\n# verdict of the discovery: found\nmodel found {\n}\n");
}
