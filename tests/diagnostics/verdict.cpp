// The verdict: errors fail, warnings and notes do not, everything is said in order of weight.
#include "diagnostics/verdict.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("nothing found is a pass") {
  Verdict const verdict = verdict_of({});
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.headline == "the checks pass");
  CHECK(findings_list({}, Surface::command_line).empty());
}

TEST_CASE("warnings and notes pass but are shown") {
  Findings const findings = {{FindingCode::reads_noise, Severity::note, {}, "a note", ""},
                             {FindingCode::second_mode, Severity::warning, {}, "a second mode", "look at both"}};
  Verdict const verdict = verdict_of(findings);
  CHECK(verdict.pass);
  CHECK(verdict.exit_code == 0);
  CHECK(verdict.headline == "use with care: 1 warning");
  CHECK(findings_list(findings, Surface::command_line) ==
        "  warning[second_mode]: a second mode\n    what to do: look at both\n"
        "  note[reads_noise]: a note\n  more: sysid explain CODE, where CODE is a word in square brackets above\n");
}

TEST_CASE("an error fails the run and leads the list") {
  Findings const findings = {{FindingCode::second_mode, Severity::warning, {}, "a warning", ""},
                             {FindingCode::chain_did_not_move, Severity::error, {}, "the chain did not move", "adapt"}};
  Verdict const verdict = verdict_of(findings);
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.exit_code == 1);
  CHECK(verdict.headline == "do not use these numbers yet: a check failed");
  CHECK(findings_list(findings, Surface::command_line) ==
        "  failed[chain_did_not_move]: the chain did not move\n    what to do: adapt\n"
        "  warning[second_mode]: a warning\n  more: sysid explain CODE, where CODE is a word in square brackets above\n");
}

TEST_CASE("where all findings have one code the last line can be typed as it stands") {
  Findings const findings = {{FindingCode::at_bound, Severity::warning, {}, "of a", ""},
                             {FindingCode::at_bound, Severity::warning, {}, "of b", ""}};
  CHECK(findings_list(findings, Surface::command_line).ends_with("\n  warning[at_bound]: of b\n  more: sysid explain at_bound\n"));
  CHECK(findings_list(findings, Surface::prompt).ends_with("\n  warning[at_bound]: of b\n  more: help at_bound\n"));
}

TEST_CASE("of a discovery five findings are shown, the heaviest, and the others are counted and named") {
  Report report;
  report.verb = "discover";
  CHECK(findings_shown(report) == 5);
  report.verb = "fit";
  CHECK(findings_shown(report) > 100);
  Findings findings;
  for (FindingCode const code : {FindingCode::terms_repeat, FindingCode::windows_missing, FindingCode::derivative_smoothed})
    findings.push_back({code, Severity::note, {}, "a note", ""});
  for (FindingCode const code :
       {FindingCode::term_idle, FindingCode::not_refitted, FindingCode::form_undecided, FindingCode::input_rule})
    findings.push_back({code, Severity::warning, {}, "a warning", ""});
  std::string const list = findings_list(findings, Surface::command_line, 5);
  CHECK(list.find("warning[input_rule]") != std::string::npos);
  CHECK(list.find("note[terms_repeat]") != std::string::npos);
  CHECK(list.find("note[windows_missing]") == std::string::npos);
  CHECK(list.find("\n  2 more (2 notes): windows_missing, derivative_smoothed; `summary.json` has all\n") != std::string::npos);
  CHECK(findings_list(findings, Surface::command_line).find("more (") == std::string::npos);
}

TEST_CASE("a run that was interrupted is unfinished before anything else is said of it") {
  Findings const findings = {{FindingCode::ess_bulk_low, Severity::error, {}, "too few", ""},
                             {FindingCode::interrupted, Severity::error, {}, "the run was interrupted", "go on"}};
  Verdict const verdict = verdict_of(findings);
  CHECK_FALSE(verdict.pass);
  CHECK(verdict.headline == "unfinished: the run was interrupted");
  CHECK(findings_list(findings, Surface::command_line) ==
        "  failed[interrupted]: the run was interrupted\n    what to do: go on\n"
        "  failed[ess_bulk_low]: too few\n  more: sysid explain CODE, where CODE is a word in square brackets above\n");
}

TEST_CASE("at the prompt an interrupted run is continued by what can be typed there, whatever its finding says") {
  Finding reworded = interrupted_finding("so far");
  CHECK(findings_list({reworded}, Surface::command_line).find("continue with --resume: ") != std::string::npos);
  CHECK(findings_list({reworded}, Surface::prompt).find("continue with `resume`: ") != std::string::npos);
  reworded.help = "other words";
  CHECK(findings_list({reworded}, Surface::command_line).find("what to do: other words\n") != std::string::npos);
  CHECK(findings_list({reworded}, Surface::prompt).find("continue with `resume`: ") != std::string::npos);
}
