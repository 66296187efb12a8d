// The verdict: errors fail, warnings and notes do not, everything is said in order of weight.
#include "diagnostics/verdict.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("nothing found is a pass") {
  Verdict const verdict = verdict_of({});
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.text == "the checks pass");
}

TEST_CASE("warnings and notes pass but are shown") {
  Verdict const verdict = verdict_of({{FindingCode::reads_noise, Severity::note, {}, "a note", ""},
                                      {FindingCode::second_mode, Severity::warning, {}, "a second mode", "look at both"}});
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.text ==
        "use with care: 1 warning\n  warning[second_mode]: a second mode\n    what to do: look at both\n"
        "  note[reads_noise]: a note\n  more: sysid explain CODE, for each word in brackets");
}

TEST_CASE("an error fails the run and leads the list") {
  Verdict const verdict = verdict_of({{FindingCode::second_mode, Severity::warning, {}, "a warning", ""},
                                      {FindingCode::chain_did_not_move, Severity::error, {}, "the chain did not move", "adapt"}});
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.exit_code == 1);
  CHECK(
      verdict.text ==
      "do not use these numbers yet: a check failed\n  failed[chain_did_not_move]: the chain did not move\n    what to do: adapt\n"
      "  warning[second_mode]: a warning\n  more: sysid explain CODE, for each word in brackets");
}

TEST_CASE("where all findings have one code the last line can be typed as it stands") {
  Verdict const verdict = verdict_of(
      {{FindingCode::at_bound, Severity::warning, {}, "of a", ""}, {FindingCode::at_bound, Severity::warning, {}, "of b", ""}});
  CHECK(verdict.text.ends_with("\n  warning[at_bound]: of b\n  more: sysid explain at_bound"));
}

TEST_CASE("a run that was interrupted is unfinished before anything else is said of it") {
  Verdict const verdict = verdict_of({{FindingCode::ess_bulk_low, Severity::error, {}, "too few", ""},
                                      {FindingCode::interrupted, Severity::error, {}, "the run was interrupted", "go on"}});
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.text ==
        "unfinished: the run was interrupted\n  failed[interrupted]: the run was interrupted\n    what to do: go on\n"
        "  failed[ess_bulk_low]: too few\n  more: sysid explain CODE, for each word in brackets");
}
