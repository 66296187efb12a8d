// Differences over steps that lower the evidence by a factor of one to three.
#include "discovery/preparation/inner_spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double aimed_drop = 0.3, least_drop = 0.05, most_drop = 1;  // of log evidence, on average of both sides
constexpr int most_trials = 14;
constexpr double first_step = 1e-3;  // of the value

/// At one value of the parameters, with the terms held.
struct Nearby {
  double log_evidence = 0;
  std::vector<Eigen::VectorXd> coefficients;  // per equation
};

class InnerSpread {
 public:
  InnerSpread(CheckedDictionary const& dictionary, std::span<Experiment const> experiments, regression::Method const& method,
              std::span<double const> values, regression::Discovery const& found)
      : dictionary_(dictionary), experiments_(experiments), method_(method), values_(values.begin(), values.end()), found_(found) {}

  /// [inner x inner]; nothing where it is not known.
  std::optional<Eigen::MatrixXd> covariance() {
    auto const here = at(values_);
    if (!here) return std::nullopt;
    auto const count = static_cast<Eigen::Index>(values_.size());
    Eigen::MatrixXd curvature(count, count);
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (!find_step(k, *here)) return std::nullopt;
    for (Eigen::Index i = 0; i < count; ++i) {
      curvature(i, i) = 2 * drop(static_cast<std::size_t>(i), *here) / std::pow(steps_[static_cast<std::size_t>(i)], 2);
      for (Eigen::Index j = 0; j < i; ++j) {
        auto const mixed = mixed_curvature(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        if (!mixed) return std::nullopt;
        curvature(i, j) = curvature(j, i) = *mixed;
      }
    }
    auto const root = cholesky(curvature);
    if (!root) return std::nullopt;
    return solve_cholesky(*root, Eigen::MatrixXd::Identity(count, count));
  }

  /// db/da of the chosen terms of an equation, [terms x inner].
  Eigen::MatrixXd slopes(std::size_t equation) const {
    Eigen::Index const rows = found_.equations[equation].chosen.coefficient.size();
    Eigen::MatrixXd out(rows, static_cast<Eigen::Index>(values_.size()));
    for (std::size_t k = 0; k < values_.size(); ++k)
      out.col(static_cast<Eigen::Index>(k)) =
          (sides_[k][1].coefficients[equation] - sides_[k][0].coefficients[equation]) / (2 * steps_[k]);
    return out;
  }

 private:
  std::optional<Nearby> at(std::vector<double> const& values) const {
    Nearby out;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!std::isfinite(log_density(dictionary_.inner[k], values[k]))) return std::nullopt;
    regression::Discovery const near =
        regression::discover(with_inner(dictionary_.numbers, dictionary_.open, dictionary_.inner, values), experiments_, method_);
    if (near.interrupted) return std::nullopt;
    for (std::size_t e = 0; e < found_.equations.size(); ++e) {
      std::vector<int> const& terms = found_.equations[e].chosen.terms;
      std::vector<regression::Support> all = near.equations[e].supports;
      all.push_back(near.equations[e].chosen);
      auto const same = std::find_if(all.begin(), all.end(), [&](regression::Support const& each) { return each.terms == terms; });
      if (!found_.equations[e].found || !near.equations[e].found || same == all.end() || !std::isfinite(same->log_evidence))
        return std::nullopt;
      out.log_evidence += same->log_evidence;
      out.coefficients.push_back(same->coefficient);
    }
    return out;
  }

  std::optional<Nearby> moved(std::size_t k, double by, std::size_t other = 0, double by_other = 0) const {
    std::vector<double> values = values_;
    values[k] += by;
    values[other] += by_other;
    return at(values);
  }

  double drop(std::size_t k, Nearby const& here) const {
    return here.log_evidence - (sides_[k][0].log_evidence + sides_[k][1].log_evidence) / 2;
  }

  bool find_step(std::size_t k, Nearby const& here) {
    double step = first_step * (values_[k] != 0 ? std::abs(values_[k]) : 1);
    sides_.emplace_back();
    steps_.push_back(step);
    for (int trial = 0; trial < most_trials; ++trial) {
      auto const below = moved(k, -step), above = moved(k, step);
      if (!below || !above) {
        step /= 4;
        continue;
      }
      sides_[k] = {*below, *above};
      steps_[k] = step;
      double const fallen = drop(k, here);
      bool const both = std::max(below->log_evidence, above->log_evidence) < here.log_evidence;
      if (both && fallen >= least_drop && fallen <= most_drop) return true;
      step *= fallen > 0 ? std::clamp(std::sqrt(aimed_drop / fallen), 0.1, 10.0) : 10;
    }
    return false;
  }

  std::optional<double> mixed_curvature(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (double const a : {-1.0, 1.0})
      for (double const b : {-1.0, 1.0}) {
        auto const near = moved(i, a * steps_[i], j, b * steps_[j]);
        if (!near) return std::nullopt;
        sum -= a * b * near->log_evidence;
      }
    return sum / (4 * steps_[i] * steps_[j]);
  }

  CheckedDictionary const& dictionary_;
  std::span<Experiment const> experiments_;
  regression::Method const& method_;
  std::vector<double> values_;
  regression::Discovery const& found_;
  std::vector<std::array<Nearby, 2>> sides_;  // per parameter
  std::vector<double> steps_;
};

}  // namespace

std::vector<double> add_inner_spread(CheckedDictionary const& dictionary, std::span<Experiment const> experiments,
                                     regression::Method const& method, std::span<double const> values,
                                     regression::Discovery& found) {
  InnerSpread spread(dictionary, experiments, method, values, found);
  auto const covariance = spread.covariance();
  if (!covariance) return {};
  for (std::size_t e = 0; e < found.equations.size(); ++e) {
    regression::FoundEquation& equation = found.equations[e];
    Eigen::MatrixXd const slopes = spread.slopes(e), more = slopes * *covariance * slopes.transpose();
    equation.chosen.covariance += more;
    for (regression::Support& each : equation.supports)
      if (each.terms == equation.chosen.terms) each.covariance = equation.chosen.covariance;
    for (std::size_t i = 0; i < equation.chosen.terms.size(); ++i) {
      regression::FoundTerm& term = equation.terms[static_cast<std::size_t>(equation.chosen.terms[i])];
      auto const row = static_cast<Eigen::Index>(i);
      term.sd = std::sqrt(equation.chosen.covariance(row, row));
      term.mean_sd = std::sqrt(term.mean_sd * term.mean_sd + more(row, row));
    }
  }
  std::vector<double> sds;
  for (Eigen::Index k = 0; k < covariance->rows(); ++k) sds.push_back(std::sqrt((*covariance)(k, k)));
  return sds;
}

}  // namespace sysid
