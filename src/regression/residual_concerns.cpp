// Limits and wording.
#include "regression/residual_concerns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "regression/column/dependence.hpp"
#include "regression/error_concerns.hpp"
#include "regression/propagated_noise.hpp"

namespace sysid::regression {
namespace {

/// Residual against noise from which on something is missing in the dictionary, and the least share that makes it worth a word.
constexpr double unexplained_above = 2;
constexpr double unexplained_share = 1e-3;
/// The same of forms on samples, whose derivatives are not exact.
constexpr double unexplained_sampled = 3, unexplained_share_sampled = 0.03;
/// Whitened residuals: over so many lags; chi^2 of as many degrees exceeds this once in a million; a row is worth less than half.
constexpr Eigen::Index lags = 20;
constexpr double far_from_white = 66, correlated_above = 2;

}  // namespace

Concerns interchangeable_terms(Equation const& equation, Eigen::MatrixXd const& joint) {
  Concerns concerns;
  for (int a = 0; a < joint.rows(); ++a)
    for (int b = a + 1; b < joint.rows(); ++b) {
      double const one = joint(a, a), other = joint(b, b), both = joint(a, b), any = one + other - both;
      if (std::min(one, other) < 0.05 || any < 0.9 || both > 0.25 * std::min(one, other)) continue;
      Concern concern{.kind = Concern::Kind::interchangeable, .terms = {a, b}, .value = any};
      concern.clause = fmt::format(
          "{} can replace each other: one is needed with probability {:.2f}, but the data do not show which one "
          "(inclusion probabilities {:.2f} and {:.2f})",
          names_of(equation, {a, b}), any, one, other);
      concerns.push_back(std::move(concern));
    }
  return concerns;
}

std::optional<Concern> unexplained_residual(double ratio, double share, bool own_noise) {
  if (ratio < unexplained_above || share < unexplained_share) return std::nullopt;
  Concern concern{.kind = Concern::Kind::unexplained, .value = ratio};
  concern.clause = fmt::format(
      "the residual is {:.3g} times what the measurement noise explains: an input or a term is "
      "missing{}",
      ratio, own_noise ? ", or a recorded input is itself noisy" : "");
  return concern;
}

std::optional<Concern> correlated_windows(Eigen::VectorXd const& residual) {
  Eigen::Index const rows = residual.size();
  if (rows < 4 * lags || !(residual.squaredNorm() > 0)) return std::nullopt;
  Portmanteau const seen = portmanteau(residual, lags);
  double const worth = 1 + 2 * seen.correlations;
  if (seen.statistic < far_from_white || worth < correlated_above) return std::nullopt;
  Concern concern{.kind = Concern::Kind::correlated, .value = worth};
  concern.clause =
      fmt::format("the residual is correlated from window to window: {} windows are equivalent to about {:.0f} independent ones",
                  rows, static_cast<double>(rows) / worth);
  return concern;
}

void check_against_noise(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                         Projection const& projection, Discovery& discovery) {
  std::vector<Columns> const noise =
      noise_of_columns(dictionary, experiments, *method.form, method.form_settings, projection, method.seed);
  for (std::size_t e = 0; e < discovery.equations.size(); ++e) {
    FoundEquation& found = discovery.equations[e];
    Columns const& columns = projection.columns(static_cast<int>(e));
    if (!found.found || noise[e].known.size() == 0) continue;
    Eigen::VectorXd left = columns.known, expected = noise[e].known;
    for (std::size_t k = 0; k < found.chosen.terms.size(); ++k) {
      double const coefficient = found.chosen.coefficient(static_cast<Eigen::Index>(k));
      left -= coefficient * columns.terms.col(found.chosen.terms[k]);
      expected -= coefficient * noise[e].terms.col(found.chosen.terms[k]);
    }
    double const ratio = left.norm() / expected.norm(), share = left.norm() / columns.known.norm();
    if (!(ratio > unexplained_sampled) || share < unexplained_share_sampled) continue;
    Concern concern{.kind = Concern::Kind::unexplained, .value = ratio};
    concern.clause = fmt::format(
        "the residual is {:.3g} times what the measurement noise explains: an input or a term is missing, or the derivatives are "
        "not accurate",
        ratio);
    found.concerns.push_back(std::move(concern));
  }
}

}  // namespace sysid::regression
