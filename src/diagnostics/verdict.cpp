// Wording of the verdict: each finding with its word for `sysid explain`.
#include "diagnostics/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sysid {

namespace {

// What the other checks say of a part of a run says little of the run.
bool is_end(Finding const& finding) { return finding.code == FindingCode::interrupted; }

}  // namespace

Finding interrupted_finding(std::string const& what) {
  return {FindingCode::interrupted,
          Severity::error,
          {},
          "the run was interrupted: " + what,
          "continue with --resume: the result will be identical to that of an uninterrupted run"};
}

Findings by_weight(Findings findings) {
  std::stable_sort(findings.begin(), findings.end(), [](Finding const& a, Finding const& b) {
    return std::pair(!is_end(a), a.severity) < std::pair(!is_end(b), b.severity);
  });
  return findings;
}

std::string with_care(std::ptrdiff_t warnings) {
  return fmt::format("use with care: {}", warnings == 1 ? "1 warning" : fmt::format("{} warnings", warnings));
}

Verdict verdict_of(Findings const& findings) {
  auto const count = [&](Severity s) {
    return std::count_if(findings.begin(), findings.end(), [&](Finding const& f) { return f.severity == s; });
  };
  auto const errors = count(Severity::error), warnings = count(Severity::warning);
  Verdict verdict;
  verdict.pass = errors == 0;
  verdict.exit_code = verdict.pass ? 0 : 1;
  if (std::any_of(findings.begin(), findings.end(), is_end))
    verdict.text = "unfinished: the run was interrupted";
  else if (errors > 0)
    verdict.text =
        fmt::format("do not use these numbers yet: {} failed", errors == 1 ? "a check" : fmt::format("{} checks", errors));
  else if (warnings > 0)
    verdict.text = with_care(warnings);
  else
    verdict.text = "the checks pass";
  for (Finding const& finding : by_weight(findings)) {
    char const* const mark = finding.severity == Severity::error     ? "failed"
                             : finding.severity == Severity::warning ? "warning"
                                                                     : "note";
    verdict.text += fmt::format("\n  {}[{}]: {}", mark, word(finding.code), finding.message);
    if (!finding.help.empty()) verdict.text += fmt::format("\n    what to do: {}", finding.help);
  }
  if (findings.empty()) return verdict;
  bool const alike =
      std::all_of(findings.begin(), findings.end(), [&](Finding const& each) { return each.code == findings.front().code; });
  verdict.text +=
      fmt::format("\n  more: sysid explain {}", alike ? word(findings.front().code) : "CODE, for each word in brackets");
  return verdict;
}

Severity grade(Report const& report) {
  Severity worst = Severity::note;
  for (Finding const& finding : report.findings) worst = std::min(worst, finding.severity);
  return worst;
}

Severity failure_severity(std::uint64_t failed, std::uint64_t solves) {
  double const share = solves == 0 ? 0 : static_cast<double>(failed) / static_cast<double>(solves);
  return share < 0.01 ? Severity::note : share < 0.2 ? Severity::warning : Severity::error;
}

bool has_verdict(Report const& report) { return report.draws.total() > 0 || !report.verdict.empty() || !report.findings.empty(); }

std::string verdict_headline(Report const& report) {
  std::string const text = report.verdict.empty() ? verdict_of(report.findings).text : report.verdict;
  return text.substr(0, text.find('\n'));
}

Severity grade(CheckPage const& page) {
  Severity worst = Severity::note;
  for (TaskPage const& task : page.tasks)
    for (Finding const& finding : task.all_findings())
      if (static_cast<int>(finding.severity) < static_cast<int>(worst)) worst = finding.severity;
  return worst;
}

}  // namespace sysid
