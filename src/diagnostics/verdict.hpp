// All findings of a run in one verdict: whether the numbers can be used, why not, what to do; and the class of the exit code.
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "result/check_page.hpp"
#include "result/report.hpp"

namespace sysid {

struct Verdict {
  bool pass = true;
  int exit_code = 0;     // 0 diagnostics pass, 1 a diagnostic fails
  std::string headline;  // in plain words
};

/// "use with care: 2 warnings".
std::string with_care(std::ptrdiff_t warnings);

/// Of a run that was stopped; what: "these are the draws so far".
Finding interrupted_finding(std::string const& what);

/// That the run was interrupted first, then errors, warnings and notes; alike in the order found.
Findings by_weight(Findings findings);

/// Fails when any finding is an error.
Verdict verdict_of(Findings const& findings);

/// How many findings of a report are shown before the rest is folded: of a discovery, whose terms have something to say each, five.
std::size_t findings_shown(Report const& report);
/// "3 more (1 warning, 2 notes): terms_repeat, windows_missing".
std::string folded_findings(std::span<Finding const> folded);

/// A line for each finding, by weight, with what to do, the first `most` of them and what the others are; then how to learn more,
/// as it is typed where this is read. Each line ends; empty where there are no findings.
std::string findings_list(Findings const& findings, Surface read_at, std::size_t most = 1000);

/// The worst of the findings; note when there are none.
Severity grade(Report const& report);

/// What failed solves mean for a result: an error from 20 % on, a warning from 1 %, a note below.
Severity failure_severity(std::uint64_t failed, std::uint64_t solves);

/// Whether there is anything to judge: a plain simulation has no diagnostics.
bool has_verdict(Report const& report);

/// As its task words it, else as verdict_of does.
std::string verdict_headline(Report const& report);

/// What a prediction's bands allow, from its findings and failures; missed: samples lie outside them (diagnostics/coverage.hpp).
std::string prediction_verdict(Report const& report, bool missed);

/// The worst of the tasks' findings; note when there are none.
Severity grade(CheckPage const& page);

}  // namespace sysid
