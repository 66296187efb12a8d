// The verdict: errors fail, warnings and notes do not, everything is said in order of weight.
#include "inference/verdict.hpp"

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
        "the checks pass, with one thing to look at\n  warning: a second mode\n    what to do: look at both\n  note: a note");
}

TEST_CASE("an error fails the run and leads the list") {
  Verdict const verdict =
      judge({{Severity::warning, "w", "a warning", ""}, {Severity::error, "e", "the chain did not move", "adapt"}});
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.exit_code == 1);
  CHECK(verdict.text ==
        "do not use these numbers yet: a check failed\n  failed: the chain did not move\n    what to do: adapt\n  warning: a "
        "warning");
}
