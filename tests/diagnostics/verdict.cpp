// The verdict: errors fail, warnings and notes do not, everything is said in order of weight.
#include "diagnostics/verdict.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("nothing found is a pass") {
  Verdict const verdict = judge({});
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.text == "the checks pass");
}

TEST_CASE("warnings and notes pass but are shown") {
  Verdict const verdict =
      judge({{Severity::note, "n", "a note", ""}, {Severity::warning, "second_mode", "a second mode", "look at both"}});
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.text ==
        "use with care: one thing to look at\n  warning[second_mode]: a second mode\n    what to do: look at both\n"
        "  note[n]: a note\n  more: sysid explain CODE, for each word in brackets");
}

TEST_CASE("an error fails the run and leads the list") {
  Verdict const verdict =
      judge({{Severity::warning, "w", "a warning", ""}, {Severity::error, "e", "the chain did not move", "adapt"}});
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.exit_code == 1);
  CHECK(verdict.text ==
        "do not use these numbers yet: a check failed\n  failed[e]: the chain did not move\n    what to do: adapt\n"
        "  warning[w]: a warning\n  more: sysid explain CODE, for each word in brackets");
}

TEST_CASE("where all findings have one code the last line can be typed as it stands") {
  Verdict const verdict = judge({{Severity::warning, "noise_size", "of a", ""}, {Severity::warning, "noise_size", "of b", ""}});
  CHECK(verdict.text.ends_with("\n  warning[noise_size]: of b\n  more: sysid explain noise_size"));
}

TEST_CASE("a run that was interrupted is unfinished before anything else is said of it") {
  Verdict const verdict = judge(
      {{Severity::error, "ess_bulk_low", "too few", ""}, {Severity::warning, "interrupted", "the run was interrupted", "go on"}});
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.text ==
        "unfinished: the run was interrupted\n  warning[interrupted]: the run was interrupted\n    what to do: go on\n"
        "  failed[ess_bulk_low]: too few\n  more: sysid explain CODE, for each word in brackets");
}
