// The tests of a mean and of a slope, whose errors allow for correlation.
#include "diagnostics/residuals/residual_line.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/numeric/statistics.hpp"
#include "diagnostics/residuals/residual_tests.hpp"

namespace sysid {
namespace {

constexpr double no_chance = 6;  // standard errors
constexpr std::size_t fewest = 20;

std::vector<double> scored_values(std::span<double const> series) {
  std::vector<double> values;
  std::copy_if(series.begin(), series.end(), std::back_inserter(values), [](double each) { return !std::isnan(each); });
  return values;
}

/// Sum of squares of the autocovariances, each times the number of samples.
double covariances(CorrelationTest const& test, std::span<double const> series) {
  double power = 0, sum = 0;
  for (double const each : series)
    if (!std::isnan(each)) power += each * each;
  for (double const each : test.correlation) sum += each * each;
  return power * power * sum;
}

double mean_square(std::span<double const> values) {
  double sum = 0;
  for (double const each : values) sum += each * each;
  return sum / static_cast<double>(values.size());
}

bool all_equal(std::vector<double> const& values) {
  return std::ranges::all_of(values, [&](double each) { return each == values.front(); });
}

bool white(std::span<double const> series) { return !whiteness(series).fires(); }

/// Whether what was subtracted to leave `rest` is most of what is correlated in the residuals; little: what may be left of the
/// squares of their autocovariances.
bool explains_correlation(std::span<double const> residuals, std::span<double const> rest, double little) {
  CorrelationTest const before = whiteness(residuals), after = whiteness(rest);
  return before.fires() && (!after.fires() || covariances(after, rest) < little * covariances(before, residuals));
}

}  // namespace

Line fitted_line(std::span<double const> time, std::span<double const> values) {
  double const middle = mean(time), center = mean(values);
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    products += (time[i] - middle) * (values[i] - center);
    squares += (time[i] - middle) * (time[i] - middle);
  }
  double const slope = squares > 0 ? products / squares : 0;
  return {slope, center - slope * middle};
}

// In means of neighbours, so that the number of products stays small.
double squared_standard_error(std::span<double const> values) {
  constexpr std::size_t most = 2000;
  std::size_t const width = (values.size() + most - 1) / most, count = values.size() / width;
  std::vector<double> means;
  for (std::size_t i = 0; i < count; ++i) means.push_back(mean(values.subspan(i * width, width)));
  double const center = mean(means);
  auto const covariance = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < count; ++i) sum += (means[i] - center) * (means[i + lag] - center);
    return sum / static_cast<double>(count);
  };
  double sum = -covariance(0);
  for (std::size_t lag = 0; lag + 1 < count; lag += 2) {
    double const pair = covariance(lag) + covariance(lag + 1);
    if (!(pair > 0)) break;
    sum += 2 * pair;
  }
  return std::max(sum, covariance(0) / static_cast<double>(count)) / static_cast<double>(count);
}

OffsetTest offset_test(std::span<double const> residuals, bool ordered) {
  OffsetTest test;
  std::vector<double> const values = scored_values(residuals);
  if (values.size() < fewest) return test;
  double const center = mean(values), variance = population_variance(values);
  // The spread of equal residuals is what their mean is rounded by: they are of unit size, if anything.
  bool const equal = all_equal(values);
  double const squared_error =
      ordered && !equal ? squared_standard_error(values) : (equal ? 1 : variance) / static_cast<double>(values.size());
  test.share = center * center / (center * center + variance);
  test.standard_errors = std::fabs(center) / std::sqrt(squared_error);
  if (!(test.standard_errors > no_chance)) return test;
  if (!ordered) {
    test.fires = test.share > 0.5;
    return test;
  }
  std::vector<double> centred(residuals.begin(), residuals.end());
  for (double& each : centred) each -= center;
  test.white_without = white(centred);
  test.fires = explains_correlation(residuals, centred, 0.05);
  return test;
}

TrendTest trend_test(std::span<double const> residuals, std::span<double const> time) {
  TrendTest test;
  std::vector<double> values, times;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (!std::isnan(residuals[i])) values.push_back(residuals[i]), times.push_back(time[i]);
  if (values.size() < fewest || all_equal(values)) return test;
  Line const line = fitted_line(times, values);
  double const middle = mean(times), spread = population_variance(times), squares = mean_square(values);
  // The slope is sum x_i r_i / sum x_i^2, x_i = t_i - mean t: its error is that of the mean of x_i e_i, e_i without the line.
  std::vector<double> products, straight(residuals.begin(), residuals.end());
  for (std::size_t i = 0; i < values.size(); ++i) products.push_back((times[i] - middle) * (values[i] - line.at(times[i])));
  double const error = std::sqrt(squared_standard_error(products)) / spread;
  test.standard_errors = std::fabs(line.slope) / error;
  for (std::size_t i = 0; i < straight.size(); ++i) straight[i] -= line.at(time[i]);
  test.share = 1 - mean_square(scored_values(straight)) / squares;
  if (!(test.standard_errors > no_chance)) return test;
  test.white_without = white(straight);
  // A step, and what bends, look like a line as far as nine tenths of their spread.
  std::vector<double> centred(residuals.begin(), residuals.end());
  double const center = mean(values);
  for (double& each : centred) each -= center;
  test.fires = explains_correlation(centred, straight, 0.01);
  return test;
}

}  // namespace sysid
