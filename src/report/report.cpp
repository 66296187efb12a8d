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

std::vector<FitLine> fit_lines(Report const& report) {
  std::vector<FitLine> out;
  if (!report.fit.empty()) out.push_back({"all channels", "", report.fit});
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities)
      if (auto found = scores(quantity, prediction.scored); !found.empty())
        out.push_back({quantity.name + " on " + prediction.experiment, quantity.unit, std::move(found)});
  if (out.size() != 2 || report.fit.empty()) return out;
  // One channel is all channels: what was found of both stands in one line, the task's own scores first.
  FitLine line{out[1].what, out[1].unit, report.fit};
  for (Score const& score : out[1].scores) {
    auto const same = [&](Score const& other) { return other.name == score.name; };
    if (std::none_of(report.fit.begin(), report.fit.end(), same)) line.scores.push_back(score);
  }
  return {line};
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace sysid
