// Importance sampling with control variates.
#include "inference/evidence/importance.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::marginal {
namespace {

/// Parts with some share, the largest first, and no more than a regression of so many draws bears.
std::vector<std::size_t> controls(std::vector<double> const& log_shares, std::size_t draws) {
  constexpr double least_log_share = -5;
  std::vector<std::size_t> order;
  for (std::size_t t = 0; t < log_shares.size(); ++t)
    if (log_shares[t] > least_log_share) order.push_back(t);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return log_shares[a] > log_shares[b]; });
  order.resize(std::min(order.size(), draws / 40));
  return order;
}

/// Draws of q, then those of the posterior.
struct BothKinds {
  Eigen::VectorXd weight;    // of means over q; they sum to 1
  Eigen::VectorXd off;       // w / Z - 1 for the guessed Z
  Eigen::MatrixXd controls;  // h, a column each
  Eigen::Index of_mixture;   // the first so many
};

BothKinds both_kinds(Mixture const& mixture, MixtureSample const& sample, PosteriorSample const& posterior, double guess) {
  constexpr double most = 300;  // of a log weight, whose square is a number yet
  std::vector<double> logs;
  for (std::size_t k = 0; k < sample.log_density.size(); ++k) logs.push_back(sample.log_density[k] - sample.log_mixture[k]);
  auto const drawn = static_cast<Eigen::Index>(logs.size());
  for (auto const& chain : posterior.of_chain)
    for (double const each : chain) logs.push_back(each - posterior.log_mixture[logs.size() - sample.log_density.size()]);
  auto const all = static_cast<Eigen::Index>(logs.size());
  std::vector<std::size_t> const used = controls(mixture.log_shares(), sample.log_density.size());
  BothKinds both{Eigen::VectorXd(all), Eigen::VectorXd(all), Eigen::MatrixXd(all, static_cast<Eigen::Index>(used.size())), drawn};
  for (Eigen::Index k = 0; k < all; ++k) {
    double const ratio = elementary::exp(std::min(most, logs[static_cast<std::size_t>(k)] - guess));
    both.off(k) = ratio - 1;
    both.weight(k) = 1 / (static_cast<double>(drawn) + static_cast<double>(all - drawn) * ratio);
  }
  both.weight /= both.weight.sum();
  for (std::size_t j = 0; j < used.size(); ++j)
    for (Eigen::Index k = 0; k < all; ++k) {
      auto const at = static_cast<std::size_t>(k);
      double const log_ratio = k < drawn ? sample.terms[used[j]][at] - sample.log_mixture[at]
                                         : posterior.terms(static_cast<int>(used[j]), static_cast<int>(k - drawn)) -
                                               posterior.log_mixture[static_cast<std::size_t>(k - drawn)];
      both.controls(k, static_cast<Eigen::Index>(j)) = elementary::exp(log_ratio) - 1;
    }
  return both;
}

/// Slopes of the weighted least squares of `off` over the controls.
Eigen::VectorXd slopes(BothKinds const& both) {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(both.controls.cols());
  if (slope.size() == 0) return slope;
  Eigen::MatrixXd const centred = both.controls.rowwise() - both.weight.transpose() * both.controls;
  Eigen::VectorXd const rest = both.off.array() - both.weight.dot(both.off);
  Eigen::MatrixXd const weighted = both.weight.asDiagonal() * centred;
  // Controls of all parts sum to nothing by their shares: what is left of such a direction is rounding.
  auto const [values, vectors] = symmetric_eigen(centred.transpose() * weighted);
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (values(k) > 1e-9 * values(values.size() - 1))
      slope += vectors.col(k).dot(weighted.transpose() * rest) / values(k) * vectors.col(k);
  return slope;
}

}  // namespace

ImportanceEstimate importance(Mixture const& mixture, MixtureSample const& sample, PosteriorSample const& posterior, double guess) {
  ImportanceEstimate const nothing{-infinity, infinity, 0, infinity};
  if (!std::isfinite(guess)) return nothing;
  BothKinds const both = both_kinds(mixture, sample, posterior, guess);
  auto const drawn = static_cast<double>(both.of_mixture);
  Eigen::VectorXd const left = both.off - both.controls * slopes(both);
  double const ratio = 1 + left.head(both.of_mixture).mean(), plain = 1 + both.off.head(both.of_mixture).mean();
  if (!(plain > 0)) return nothing;
  auto const error = [&](Eigen::VectorXd const& values, double mean) {
    Eigen::VectorXd const squares = (values.array() - (mean - 1)).square();
    return std::sqrt(std::max(both.weight.dot(squares), squares.head(both.of_mixture).mean()) / drawn) / mean;
  };
  double const plain_error = error(both.off, plain);
  double const effective = drawn / both.weight.dot(((both.off.array() + 1) / plain).square().matrix());
  if (!(ratio > 0)) return {guess + elementary::log(plain), plain_error, effective, plain_error};
  return {guess + elementary::log(ratio), error(left, ratio), effective, plain_error};
}

}  // namespace sysid::marginal
