// The verdict, as all writers show it.
#include "report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inference/verdict.hpp"

namespace sysid {

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
  std::string const text = report.verdict.empty() ? judge(report.findings).text : report.verdict;
  return text.substr(0, text.find('\n'));
}

std::string evidence_text(Evidence const& evidence) {
  constexpr double rough = 0.5;  // nats: below, no comparison turns on it
  if (!evidence.log_evidence) return evidence.of_likelihood ? "" : fmt::format("no log evidence: {}", evidence.reason);
  return fmt::format(
      "log evidence {:.1f} (Laplace{})", *evidence.log_evidence,
      std::fabs(evidence.along_axes) < rough ? "" : fmt::format(", rough: {:+.1f} along its axes", evidence.along_axes));
}

std::vector<FitLine> fit_lines(Report const& report) {
  std::vector<FitLine> lines = report.fit;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities) {
      std::vector<Score> const found = scores(quantity, prediction.scored);
      if (found.empty()) continue;
      auto line = std::find_if(lines.begin(), lines.end(), [&](FitLine const& each) {
        return each.experiment == prediction.experiment && each.channel == quantity.name;
      });
      if (line == lines.end()) line = lines.insert(line, {prediction.experiment, quantity.name, "", {}});
      line->unit = quantity.unit;
      for (Score const& score : found)
        if (std::none_of(line->scores.begin(), line->scores.end(), [&](Score const& other) { return other.name == score.name; }))
          line->scores.push_back(score);
    }
  return lines;
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace sysid
