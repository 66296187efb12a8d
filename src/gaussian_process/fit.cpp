// Starts, the climb from each, and what the best optimum gives reason to doubt.
#include "gaussian_process/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "gaussian_process/maximise.hpp"

namespace sysid::gaussian_process {
namespace {

/// Optima closer than this in log density are one.
constexpr double same_optimum = 0.01;

/// The ranges that are free, as logarithms, and the whole vector from them.
struct Coordinates {
  std::vector<Range> const& ranges;
  std::vector<std::size_t> free;
  Eigen::VectorXd lower, upper, known;  // known: logarithms of all starts

  explicit Coordinates(std::vector<Range> const& all) : ranges(all), known(static_cast<Eigen::Index>(all.size())) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      known[static_cast<Eigen::Index>(i)] = elementary::log(all[i].start);
      if (all[i].lower < all[i].upper) free.push_back(i);
    }
    lower.resize(static_cast<Eigen::Index>(free.size()));
    upper.resize(lower.size());
    for (std::size_t n = 0; n < free.size(); ++n) {
      lower[static_cast<Eigen::Index>(n)] = elementary::log(all[free[n]].lower);
      upper[static_cast<Eigen::Index>(n)] = elementary::log(all[free[n]].upper);
    }
  }
  Eigen::VectorXd logarithms(Eigen::VectorXd const& at) const {
    Eigen::VectorXd all = known;
    for (std::size_t n = 0; n < free.size(); ++n) all[static_cast<Eigen::Index>(free[n])] = at[static_cast<Eigen::Index>(n)];
    return all;
  }
  /// What is known stays as it was given: exp(log(x)) may differ in the last digit, and 0 has no logarithm.
  std::vector<double> parameters(Eigen::VectorXd const& at) const {
    std::vector<double> all;
    for (Range const& range : ranges) all.push_back(range.start);
    for (std::size_t n = 0; n < free.size(); ++n) all[free[n]] = elementary::exp(at[static_cast<Eigen::Index>(n)]);
    return all;
  }
  Eigen::VectorXd start(int number, FitSettings const& settings) const {
    Stream stream(settings.key.with_index(static_cast<std::uint64_t>(number)));
    Eigen::VectorXd at(lower.size());
    double const spread = elementary::log(settings.spread);
    for (Eigen::Index n = 0; n < at.size(); ++n) {
      double const middle = known[static_cast<Eigen::Index>(free[static_cast<std::size_t>(n)])];
      double const low = std::max(lower[n], middle - spread), high = std::min(upper[n], middle + spread), u = stream.uniform();
      at[n] = std::clamp(number == 0 ? middle : low + (high - low) * u, lower[n], upper[n]);
    }
    return at;
  }
};

Concern fatal_concern(Outcome outcome) {
  switch (outcome) {
    case Outcome::not_positive_definite:
      return {.kind = Concern::Kind::not_positive_definite,
              .clause = "the covariance of the observations is not positive definite, even with the largest jitter allowed"};
    case Outcome::dependent_columns:
      return {.kind = Concern::Kind::dependent_columns, .clause = "two coefficients of the mean without a prior are collinear"};
    default:
      return {.kind = Concern::Kind::not_finite, .clause = "the likelihood is not finite at any start"};
  }
}

void look_at(Optimum const& best, Coordinates const& coordinates, Concerns& concerns) {
  for (std::size_t const i : coordinates.free) {
    Range const& range = coordinates.ranges[i];
    for (double const bound : {range.lower, range.upper})
      if (std::fabs(elementary::log(best.parameters[i] / bound)) < 1e-6)
        concerns.push_back({.kind = Concern::Kind::at_bound,
                            .parameter = static_cast<int>(i),
                            .value = bound,
                            .clause = fmt::format("{} ended at the {} bound of its range, {:.4g}", range.name,
                                                  bound == range.lower ? "lower" : "upper", bound)});
  }
  if (best.jitter > 0)
    concerns.push_back({.kind = Concern::Kind::jitter,
                        .value = best.jitter,
                        .clause = fmt::format("the covariance needed {:.0e} of its mean variance on the diagonal", best.jitter)});
  if (!best.converged)
    concerns.push_back({.kind = Concern::Kind::no_convergence,
                        .value = static_cast<double>(best.evaluations),
                        .clause = fmt::format("the best start did not converge in {} evaluations", best.evaluations)});
}

}  // namespace

std::optional<std::vector<Range>> suggested_ranges(Covariance const& covariance, Observations const& observations) {
  double const mean = observations.values.mean();
  double const spread = std::sqrt((observations.values.array() - mean).square().mean());
  double const output = spread > 0 ? spread : 1;
  auto const power = [](double base, int exponent) {
    double result = 1;
    for (int i = 0; i < std::abs(exponent); ++i) result *= exponent > 0 ? base : 1 / base;
    return result;
  };
  std::vector<Range> result;
  for (HyperParameter const& one : covariance.hyper_parameters()) {
    if (one.unit.own != 0) return std::nullopt;
    std::vector<int> const& columns = covariance.terms()[static_cast<std::size_t>(one.term)].columns;
    double input = 1;
    if (one.unit.input != 0) {
      auto const column = observations.inputs.col(one.column >= 0 ? one.column : columns.front());
      double const width = column.maxCoeff() - column.minCoeff();
      if (width > 0) input = width;
    }
    // A third of the width: the first start is neither a straight line nor noise.
    double const scale = power(output, one.unit.output) * power(input / 3, one.unit.input);
    std::string name(one.name);
    if (one.column >= 0) name += fmt::format(" of input {}", one.column + 1);
    result.push_back({std::move(name), scale / 1000, scale * 1000, scale});
  }
  result.push_back({"sd of the noise", 1e-6 * output, 10 * output, 0.1 * output});
  return result;
}

Fit fit(Likelihood const& likelihood, LogPrior const& prior, std::vector<Range> const& ranges, Eigen::Index observations,
        FitSettings const& settings) {
  Coordinates const coordinates(ranges);
  Outcome failure = Outcome::not_finite;
  Density const density = [&](Eigen::VectorXd const& at, Eigen::VectorXd& gradient) {
    Marginal const marginal = likelihood(coordinates.parameters(at), true);
    if (marginal.outcome != Outcome::fine) {
      failure = marginal.outcome;
      return -infinity;
    }
    Eigen::VectorXd all = marginal.gradient;
    double value = marginal.log_likelihood;
    if (prior) value += prior(coordinates.logarithms(at), all);
    for (std::size_t n = 0; n < coordinates.free.size(); ++n)
      gradient[static_cast<Eigen::Index>(n)] = all[static_cast<Eigen::Index>(coordinates.free[n])];
    return value;
  };

  Fit result;
  ClimbSettings const climbing{static_cast<double>(std::max<Eigen::Index>(1, observations)), settings.tolerance,
                               settings.most_evaluations};
  for (int number = 0; number < (coordinates.free.empty() ? 1 : settings.starts); ++number) {
    Climb climb;
    climb.at = coordinates.start(number, settings);
    if (coordinates.free.empty()) {
      climb.value = density(climb.at, climb.gradient);
      climb.converged = true;
    } else {
      climb = maximise(density, climb.at, coordinates.lower, coordinates.upper, climbing);
    }
    if (!std::isfinite(climb.value)) continue;
    Optimum optimum{coordinates.parameters(climb.at), climb.value, 0, 0, climb.evaluations, climb.converged};
    Marginal const there = likelihood(optimum.parameters, false);
    optimum.log_likelihood = there.log_likelihood;
    optimum.jitter = there.jitter;
    result.optima.push_back(std::move(optimum));
  }
  std::stable_sort(result.optima.begin(), result.optima.end(),
                   [](Optimum const& a, Optimum const& b) { return a.log_density > b.log_density; });
  if (result.optima.empty()) {
    result.concerns.push_back(fatal_concern(failure));
    return result;
  }
  Optimum const& best = result.optima.front();
  look_at(best, coordinates, result.concerns);
  for (Optimum const& other : result.optima)
    if (double const short_by = best.log_density - other.log_density; short_by > same_optimum && other.converged) {
      result.concerns.push_back({.kind = Concern::Kind::restarts_differ,
                                 .value = short_by,
                                 .clause = fmt::format("another start ended {:.3g} below the best in log density", short_by)});
      break;
    }
  return result;
}

}  // namespace sysid::gaussian_process
