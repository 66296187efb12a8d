// Adaptation of a proposal's covariance and scale.
#include "inference/chain/adaptation.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/objective.hpp"

namespace sysid::metropolis {
namespace {

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

void Adaptation::learn(State const& state, Info const& info, std::span<char const> away) {
  if (iteration_ == 0) {
    mean_.resize(covariance_.rows(), static_cast<Eigen::Index>(chains_.size()));
    for (std::size_t c = 0; c < chains_.size(); ++c) mean_.col(static_cast<Eigen::Index>(c)) = column(state.theta, chains_[c]);
  }
  ++iteration_;
  learn_scale(info);
  learn_shape(state, away);
  if (iteration_ % 10 == 0) refactor();
}

void Adaptation::learn_scale(Info const& info) {
  double acceptance = 0;
  int moves = 0, walks = 0;
  for (int const chain : chains_) {
    Move const& move = info[static_cast<std::size_t>(chain)];
    bool const walked = move.kind == MoveKind::walk;
    walks += walked ? 1 : 0;
    if (!walked || move.failed || !move.tunes_scale) continue;  // a failed solve says nothing of the posterior's width
    acceptance += move.acceptance_probability;
    ++moves;
  }
  if (walks > 0) ++walks_;
  if (moves == 0) return;
  log_scale_ += learning_gain(best_acceptance, walks_) * (acceptance / moves - best_acceptance);
}

void Adaptation::learn_shape(State const& state, std::span<char const> away) {
  Eigen::Index const dimension = covariance_.rows();
  double const weight = 2 / (static_cast<double>(iteration_) + 10 * static_cast<double>(dimension));
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(dimension, dimension);
  int here = 0;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    if (away[static_cast<std::size_t>(chains_[c])] != 0) continue;
    auto mean = mean_.col(static_cast<Eigen::Index>(c));
    Eigen::VectorXd const step = column(state.theta, chains_[c]) - mean;
    spread += step * step.transpose();
    mean += weight * step;
    ++here;
  }
  if (here > 0) covariance_ += weight * (spread / here - covariance_);
}

Eigen::VectorXd Adaptation::mean() const { return mean_.rowwise().mean(); }

Eigen::MatrixXd Adaptation::covariance() const {
  Eigen::MatrixXd const apart = mean_.colwise() - mean();
  return covariance_ + apart * apart.transpose() / static_cast<double>(chains_.size());
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
          {"walks", walks_},
          {"factor", checkpoint::encode(std::span<double const>(proposal_.factor))},
          {"scales", checkpoint::encode(std::vector<double>{log_scale_, proposal_.scale})}};
}

Adaptation Adaptation::restore(nlohmann::json const& stored, int parameters, int chains) {
  Adaptation a;
  a.chains_ = stored.at("chains").get<std::vector<int>>();
  auto const dimension = stored.at("dimension").get<Eigen::Index>();
  bool const known = std::all_of(a.chains_.begin(), a.chains_.end(), [&](int chain) { return chain >= 0 && chain < chains; });
  if (dimension != parameters || a.chains_.empty() || !known)
    throw checkpoint::Mismatch("its chains differ in number or dimension");
  a.first_ = to_matrix(checkpoint::decode(stored.at("first")), dimension, dimension);
  a.covariance_ = to_matrix(checkpoint::decode(stored.at("covariance")), dimension, dimension);
  a.iteration_ = stored.at("iteration").get<std::uint64_t>();
  a.walks_ = stored.at("walks").get<std::uint64_t>();
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
