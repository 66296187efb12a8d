// Measured samples against the bands that should hold them.
#include "diagnostics/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "diagnostics/residuals/explained.hpp"
#include "diagnostics/scores.hpp"

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

/// Whether a band is that of a quantity whose logarithm is symmetric about its middle: the mean lies nearer to the geometric one.
bool is_logarithmic(double lower, double upper, double mean) {
  return lower > 0 && std::fabs(mean - std::sqrt(lower * upper)) < std::fabs(mean - (lower + upper) / 2);
}

/// What the bands of a channel miss the measured samples by, in sds of the bands, and how much of the bands' variance is that of
/// the response: the errors of parameters, states and functions, which last from sample to sample, where noise does not.
struct BandErrors {
  std::vector<double> values;
  double lasting = 0;
};

BandErrors band_errors(Report const& report, FitLine const& line) {
  constexpr double half_width = 1.96;  // sds
  BandErrors errors;
  double share = 0;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities) {
      if (prediction.experiment != line.experiment || quantity.name != line.channel) continue;
      for (std::size_t i = 0; i < std::min(quantity.measured.size(), quantity.noisy.lower.size()); ++i) {
        if (prediction.scored[i] == 0 || std::isnan(quantity.measured[i])) continue;
        double lower = quantity.noisy.lower[i], upper = quantity.noisy.upper[i], measured = quantity.measured[i];
        bool const with_response = i < quantity.response.lower.size();
        double from = with_response ? quantity.response.lower[i] : 0, to = with_response ? quantity.response.upper[i] : 0;
        if (is_logarithmic(lower, upper, quantity.noisy.mean[i]))
          for (double* const each : {&lower, &upper, &measured, &from, &to})
            *each = elementary::log(std::max(*each, std::numeric_limits<double>::min()));
        double const width = upper - lower;
        if (!(width > 0) || !std::isfinite(width)) continue;
        errors.values.push_back((measured - (lower + upper) / 2) / (width / (2 * half_width)));
        double const response = (to - from) / width;
        share += std::isfinite(response) ? std::min(response * response, 1.0) : 0;
      }
    }
  if (!errors.values.empty()) errors.lasting = share / static_cast<double>(errors.values.size());
  return errors;
}

// Two events that normal errors of correlation r both decide, whatever their signs, are correlated by r^2 at most. Errors of a
// right model are correlated by no more than what lasts of them, and white noise by less than two standard errors.
double effective_samples(BandErrors const& errors) {
  constexpr std::size_t longest_lag = 2000;
  std::span<double const> const values(errors.values);
  std::size_t const n = values.size();
  auto const product = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < n; ++i) sum += values[i] * values[i + lag];
    return sum / static_cast<double>(n - lag);
  };
  double const power = n > 0 ? product(0) : 0;
  double sum = 1;
  for (std::size_t lag = 1; power > 0 && lag <= std::min(n / 2, longest_lag); ++lag) {
    double const correlation = std::min(std::abs(product(lag)) / power, 1.0), count = static_cast<double>(n - lag);
    if (correlation > 2 / std::sqrt(count))
      sum += 2 * count / static_cast<double>(n) * std::pow(std::min(correlation, errors.lasting), 2);
  }
  return static_cast<double>(n) / sum;
}

// A record of which most samples lie outside is told where a right model would leave one of a hundred such records.
constexpr double chance = 0.001, chance_of_most = 0.01;

// Of n independent samples each lies outside with probability 0.05: that many or more, by the incomplete beta function, which is
// the binomial tail for whole numbers and goes on between them.
bool too_many_outside(double coverage, double samples, double chance) {
  constexpr double outside = 0.05;
  double const count = (1 - coverage) * samples;
  return count > 0 && boost::math::ibeta(count, samples - count + 1, outside) < chance;
}

// The mean square of n independent standard normal errors, by chi-squared with n degrees of freedom.
bool too_large(double mean_square, double samples, double chance) {
  return boost::math::gamma_q(samples / 2, samples * mean_square / 2) < chance;
}

// The samples are too many outside a 95 % band; and of as many independent ones as they are worth too many still, or too far.
bool misses(double coverage, double samples, BandErrors const& errors) {
  if (coverage >= least_coverage || !too_many_outside(coverage, samples, chance)) return false;
  if (errors.values.empty()) return true;
  double square = 0;
  for (double const each : errors.values) square += each * each;
  double const worth = effective_samples(errors);
  double const rare = coverage < 0.5 ? chance_of_most : chance;
  return too_many_outside(coverage, worth, rare) || too_large(square / static_cast<double>(errors.values.size()), worth, rare);
}

}  // namespace

bool add_coverage(Report& report, bool fed_back) {
  bool any = false;
  for (FitLine const& line : fit_lines(report))
    if (auto const error = find_score(line.scores, {ScoreKind::nmse});
        error && *error > as_bad_as_the_mean(measured_samples(report, line)))
      report.findings.push_back(worse_than_the_mean(
          *error > useless_nmse ? Severity::error : Severity::warning, {line.channel, line.experiment}, line.what(), *error,
          "check units, signs and columns of this record, its start, and the verdict of the fit"));
  for (FitLine const& line : fit_lines(report)) {
    auto const inside = find_score(line.scores, {ScoreKind::coverage_95});
    if (!inside || !misses(*inside, static_cast<double>(measured_samples(report, line)), band_errors(report, line))) continue;
    any = true;
    report.findings.push_back(
        {FindingCode::coverage_low,
         Severity::warning,
         {line.channel, line.experiment},
         fmt::format("only {:.3g} % of the samples of {} lie inside the 95 % band", 100 * *inside, line.what()),
         fed_back ? "look for disturbances that act on the system: the bands of a free run include only the uncertainty of the "
                    "parameters and the noise of each sample"
                  : "the model or its noise does not describe these data: check the residuals, and inputs outside the range "
                    "that was fitted"});
  }
  return any;
}

}  // namespace sysid
