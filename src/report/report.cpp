// The verdict, as all writers show it.
#include "report/report.hpp"

#include <algorithm>

#include "inference/verdict.hpp"

namespace sysid {

Severity grade(Report const& report) {
  Severity worst = Severity::note;
  for (Finding const& finding : report.findings) worst = std::min(worst, finding.severity);
  return worst;
}

bool has_verdict(Report const& report) { return report.draws.total() > 0 || !report.verdict.empty() || !report.findings.empty(); }

std::string verdict_headline(Report const& report) {
  std::string const text = report.verdict.empty() ? judge(report.findings).text : report.verdict;
  return text.substr(0, text.find('\n'));
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace sysid
