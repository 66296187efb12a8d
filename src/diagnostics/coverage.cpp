// Measured samples against the bands that should hold them.
#include "diagnostics/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics/residual_checks.hpp"
#include "diagnostics/scores.hpp"
#include "diagnostics/verdict.hpp"

namespace sysid {
namespace {

constexpr double least_coverage = 0.9;  // of a 95 % band: twice as many outside as should be

std::size_t measured_samples(Report const& report, FitLine const& line) {
  std::size_t count = 0;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities) {
      if (prediction.experiment != line.experiment || quantity.name != line.channel) continue;
      for (std::size_t i = 0; i < quantity.measured.size(); ++i)
        count += prediction.scored[i] != 0 && !std::isnan(quantity.measured[i]);
    }
  return count;
}

// So few inside a 95 % band that chance will not do it: 3.3 binomial sds and one sample besides.
bool misses(double coverage, double samples) {
  constexpr double expected = 0.95;
  double const short_of = (expected - coverage) * samples;
  return coverage < least_coverage && short_of > 3.3 * std::sqrt(samples * expected * (1 - expected)) + 1;
}

}  // namespace

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

bool add_coverage(Report& report, bool fed_back) {
  bool any = false;
  for (FitLine const& line : fit_lines(report))
    for (Score const& score : line.scores)
      if (score.name == "nmse" && score.value > as_bad_as_the_mean(measured_samples(report, line)))
        report.findings.push_back(worse_than_the_mean(
            score.value > useless_nmse ? Severity::error : Severity::warning, {line.channel, line.experiment}, line.what(),
            score.value, "check units, signs and columns of this record, its start, and the verdict of the fit"));
  for (FitLine const& line : fit_lines(report))
    for (Score const& score : line.scores) {
      if (score.name != "coverage_95" || !misses(score.value, static_cast<double>(measured_samples(report, line)))) continue;
      any = true;
      report.findings.push_back(
          {FindingCode::coverage_low,
           Severity::warning,
           {line.channel, line.experiment},
           fmt::format("only {:.3g} % of the samples of {} lie inside the 95 % band", 100 * score.value, line.what()),
           fed_back ? "look for disturbances that act on the system: the bands of a free run include only the uncertainty of the "
                      "parameters and the noise of each sample"
                    : "the model or its noise does not describe these data: check the residuals, and inputs outside the range "
                      "that was fitted"});
    }
  return any;
}

}  // namespace sysid
