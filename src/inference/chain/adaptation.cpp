// Adaptation of a proposal's covariance and scale.
#include "inference/chain/adaptation.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::metropolis {
namespace {

constexpr double target_acceptance = 0.234;
constexpr double small_share = 0.1;

Eigen::MatrixXd to_matrix(std::vector<double> const& v, Eigen::Index rows, Eigen::Index columns) {
  if (static_cast<Eigen::Index>(v.size()) != rows * columns) throw checkpoint::Mismatch("its proposal differs in dimension");
  return Eigen::Map<Eigen::MatrixXd const>(v.data(), rows, columns);
}

}  // namespace

Adaptation::Adaptation(std::vector<int> chains, Eigen::MatrixXd covariance)
    : chains_(std::move(chains)), first_(std::move(covariance)), covariance_(first_) {
  auto const dimension = static_cast<int>(first_.rows());
  proposal_ = spherical(dimension, 1);
  proposal_.small_share = small_share;
  log_scale_ = elementary::log(2.38 / std::sqrt(static_cast<double>(dimension)));
  refactor();
}

void Adaptation::refactor() {
  auto const factor = cholesky(covariance_ + 1e-9 * first_);
  proposal_.scale = elementary::exp(log_scale_);
  if (!factor) return;  // the former factor serves on
  Eigen::Index const n = covariance_.rows();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) proposal_.factor[static_cast<std::size_t>(i * n + j)] = (*factor)(i, j);
}

void Adaptation::learn(State const& state, Info const& info) {
  Eigen::Index const dimension = covariance_.rows();
  auto const group = static_cast<Eigen::Index>(chains_.size());
  auto const theta = [&](Eigen::Index c) {
    Eigen::VectorXd x(dimension);
    for (Eigen::Index p = 0; p < dimension; ++p) x(p) = state.theta(static_cast<int>(p), chains_[static_cast<std::size_t>(c)]);
    return x;
  };
  if (iteration_ == 0) {
    mean_.resize(dimension, group);
    for (Eigen::Index c = 0; c < group; ++c) mean_.col(c) = theta(c);
  }
  ++iteration_;
  double const n = static_cast<double>(iteration_);

  double acceptance = 0;
  int moves = 0;
  for (int const chain : chains_) {
    Move const& move = info[static_cast<std::size_t>(chain)];
    if (move.failed || move.small) continue;  // a failed solve says nothing of the posterior's width
    acceptance += move.acceptance_probability;
    ++moves;
  }
  if (moves > 0) {
    // 1 / (a (1 - a)) is the gain that is optimal in one dimension (Garthwaite, Fan and Sisson 2016); n^-0.6 lets it settle.
    double const gain = 1 / (target_acceptance * (1 - target_acceptance)) * elementary::pow(n, -0.6);
    log_scale_ += std::min(1.0, gain) * (acceptance / moves - target_acceptance);
  }

  double const weight = 2 / (n + 10 * static_cast<double>(dimension));
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(dimension, dimension);
  for (Eigen::Index c = 0; c < group; ++c) {
    Eigen::VectorXd const step = theta(c) - mean_.col(c);
    spread += step * step.transpose();
    mean_.col(c) += weight * step;
  }
  covariance_ += weight * (spread / static_cast<double>(group) - covariance_);
  if (iteration_ % 10 == 0) refactor();
}

nlohmann::json Adaptation::store() const {
  auto const block = [](Eigen::MatrixXd const& m) {
    return checkpoint::encode(std::span<double const>(m.data(), static_cast<std::size_t>(m.size())));
  };
  return {{"chains", chains_},
          {"dimension", covariance_.rows()},
          {"first", block(first_)},
          {"covariance", block(covariance_)},
          {"mean", block(mean_)},
          {"iteration", iteration_},
          {"factor", checkpoint::encode(std::span<double const>(proposal_.factor))},
          {"scales", checkpoint::encode(std::vector<double>{log_scale_, proposal_.scale})}};
}

Adaptation Adaptation::restore(nlohmann::json const& stored) {
  Adaptation a;
  a.chains_ = stored.at("chains").get<std::vector<int>>();
  auto const dimension = stored.at("dimension").get<Eigen::Index>();
  a.first_ = to_matrix(checkpoint::decode(stored.at("first")), dimension, dimension);
  a.covariance_ = to_matrix(checkpoint::decode(stored.at("covariance")), dimension, dimension);
  a.iteration_ = stored.at("iteration").get<std::uint64_t>();
  auto const group = static_cast<Eigen::Index>(a.chains_.size());
  if (a.iteration_ > 0) a.mean_ = to_matrix(checkpoint::decode(stored.at("mean")), dimension, group);
  std::vector<double> const scales = checkpoint::decode(stored.at("scales"), 2);
  a.log_scale_ = scales.at(0);
  a.proposal_ = {static_cast<int>(dimension), checkpoint::decode(stored.at("factor")), scales.at(1), small_share};
  if (a.proposal_.factor.size() != static_cast<std::size_t>(dimension * dimension))
    throw checkpoint::Mismatch("its proposal differs in dimension");
  return a;
}

}  // namespace sysid::metropolis
