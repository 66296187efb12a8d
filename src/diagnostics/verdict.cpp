// Wording of the verdict: each finding with its word for `sysid explain`.
#include "diagnostics/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/text/words.hpp"

namespace sysid {

namespace {

/// Of a run that was interrupted.
std::string resume_help(Surface read_at) {
  return fmt::format("continue with {}: the result will be identical to that of an uninterrupted run", to_resume(read_at));
}

// What the other checks say of a part of a run says little of the run.
bool is_end(Finding const& finding) { return finding.code == FindingCode::interrupted; }

/// What to do, as it is typed at `read_at`; findings hold it as typed at the command line.
std::string help_at(Finding const& finding, Surface read_at) {
  if (read_at == Surface::prompt && is_end(finding)) return resume_help(read_at);
  return finding.help;
}

}  // namespace

Finding interrupted_finding(std::string const& what) {
  return {FindingCode::interrupted, Severity::error, {}, "the run was interrupted: " + what, resume_help(Surface::command_line)};
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
    verdict.headline = "unfinished: the run was interrupted";
  else if (errors > 0)
    verdict.headline =
        fmt::format("do not use these numbers yet: {} failed", errors == 1 ? "a check" : fmt::format("{} checks", errors));
  else if (warnings > 0)
    verdict.headline = with_care(warnings);
  else
    verdict.headline = "the checks pass";
  return verdict;
}

std::size_t findings_shown(Report const& report) { return report.verb == "discover" ? 5 : 1000; }

std::string folded_findings(std::span<Finding const> folded) {
  std::vector<std::string> counts, codes;
  for (auto const& [severity, name] :
       {std::pair(Severity::error, "failed check"), {Severity::warning, "warning"}, {Severity::note, "note"}})
    if (auto const n = std::count_if(folded.begin(), folded.end(), [&](Finding const& each) { return each.severity == severity; });
        n > 0)
      counts.push_back(counted(n, name));
  for (Finding const& each : folded)
    if (std::find(codes.begin(), codes.end(), word(each.code)) == codes.end()) codes.emplace_back(word(each.code));
  return fmt::format("{} more ({}): {}", folded.size(), fmt::join(counts, ", "), fmt::join(codes, ", "));
}

std::string findings_list(Findings const& findings, Surface read_at, std::size_t most) {
  std::string list;
  Findings const weighed = by_weight(findings);
  std::span<Finding const> const all(weighed);
  std::span<Finding const> const shown = all.first(std::min(most, all.size()));
  for (Finding const& finding : shown) {
    char const* const mark = finding.severity == Severity::error     ? "failed"
                             : finding.severity == Severity::warning ? "warning"
                                                                     : "note";
    list += fmt::format("  {}[{}]: {}\n", mark, word(finding.code), finding.message);
    if (!finding.help.empty()) list += fmt::format("    what to do: {}\n", help_at(finding, read_at));
  }
  if (findings.empty()) return list;
  if (shown.size() < all.size()) list += fmt::format("  {}; `summary.json` has all\n", folded_findings(all.subspan(shown.size())));
  bool const alike =
      std::all_of(findings.begin(), findings.end(), [&](Finding const& each) { return each.code == findings.front().code; });
  if (read_at == Surface::prompt)
    return list + (alike ? fmt::format("  more: help {}\n", word(findings.front().code))
                         : "  more: `help WORD`, where WORD is a word in square brackets above\n");
  return list + fmt::format("  more: sysid explain {}\n",
                            alike ? word(findings.front().code) : "CODE, where CODE is a word in square brackets above");
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
  return report.verdict.empty() ? verdict_of(report.findings).headline : report.verdict;
}

std::string prediction_verdict(Report const& report, bool missed) {
  auto const has = [&](FindingCode code, Severity severity) {
    return std::any_of(report.findings.begin(), report.findings.end(),
                       [&](Finding const& each) { return each.code == code && each.severity == severity; });
  };
  if (has(FindingCode::from_doubtful_fit, Severity::error))
    return "do not use these bands: the fit whose draws they use failed its checks";
  if (has(FindingCode::worse_than_the_mean, Severity::error))
    return "do not use these bands: the mean of the record predicts better";
  if (grade(report) == Severity::error) return "do not use these bands: too many trajectories are left out";
  if (report.ledger.failed() > 0) return "use with care: some trajectories do not stay finite";
  if (has(FindingCode::worse_than_the_mean, Severity::warning)) return "use with care: the mean of the record predicts better";
  if (missed) return "use with care: too many samples lie outside the bands";
  if (has(FindingCode::from_doubtful_fit, Severity::warning)) return "use with care: the fit whose draws are used has warnings";
  auto const warnings = std::count_if(report.findings.begin(), report.findings.end(),
                                      [](Finding const& each) { return each.severity == Severity::warning; });
  if (warnings > 0) return with_care(warnings);
  return "the checks pass (all trajectories stay finite)";
}

Severity grade(CheckPage const& page) {
  Severity worst = Severity::note;
  for (TaskPage const& task : page.tasks)
    for (Finding const& finding : task.all_findings()) worst = std::min(worst, finding.severity);
  return worst;
}

}  // namespace sysid
