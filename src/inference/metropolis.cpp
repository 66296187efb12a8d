// Random-walk Metropolis over lanes.
#include "inference/metropolis.hpp"

#include <algorithm>
#include <cmath>

#include "core/elementary.hpp"

namespace sysid::metropolis {
namespace {

/// Writes the proposed state of one chain; returns whether the move is a small one.
bool propose(Proposal const& proposal, StreamKey key, ConstLanes from, Lanes to, int lane) {
  Stream stream(key);
  bool const small = proposal.small_share > 0 && stream.uniform() < proposal.small_share;
  double const scale = small ? proposal.small_scale * proposal.scale : proposal.scale;
  auto const dimension = static_cast<std::size_t>(proposal.dimension);
  double normals[64];
  std::vector<double> many;
  double* z = normals;
  if (dimension > std::size(normals)) {
    many.resize(dimension);
    z = many.data();
  }
  for (std::size_t i = 0; i < dimension; ++i) z[i] = stream.normal();
  for (std::size_t i = 0; i < dimension; ++i) {
    double move = 0;
    for (std::size_t j = 0; j <= i; ++j) move += proposal.factor[i * dimension + j] * z[j];
    to(static_cast<int>(i), lane) = from(static_cast<int>(i), lane) + scale * move;
  }
  return small;
}

}  // namespace

Proposal spherical(int dimension, double variance) {
  auto const n = static_cast<std::size_t>(dimension);
  Proposal proposal{dimension, std::vector<double>(n * n, 0.0), std::sqrt(variance)};
  for (std::size_t i = 0; i < n; ++i) proposal.factor[i * n + i] = 1;
  return proposal;
}

State init(Target const& target, LaneArray theta, Ledger& ledger) {
  auto const width = static_cast<std::size_t>(theta.width());
  State state{std::move(theta), std::vector<double>(width), std::vector<double>(width)};
  target.log_prior(state.theta, state.log_prior);
  target.log_likelihood(state.theta, state.log_likelihood, ledger);
  return state;
}

Info step(Target const& target, std::span<Proposal const* const> proposals, StreamKey key, State& state, Ledger& ledger) {
  int const width = state.theta.width();
  auto const lanes = static_cast<std::size_t>(width);
  Info info{std::vector<double>(lanes, 0.0), std::vector<char>(lanes, 0), std::vector<char>(lanes, 0), std::vector<char>(lanes, 0)};
  LaneArray proposed(state.theta.rows(), width);
  std::vector<double> log_prior(lanes), log_likelihood(lanes);
  for (std::size_t w = 0; w < lanes; ++w) {
    StreamKey const chain{key.seed, Purpose::proposal, key.index + w, key.step};
    info.small[w] = propose(*proposals[w], chain, state.theta, proposed, static_cast<int>(w));
  }
  target.log_prior(proposed, log_prior);
  target.log_likelihood(proposed, log_likelihood, ledger);
  for (std::size_t w = 0; w < lanes; ++w) {
    double const now = state.log_prior[w] + state.log_likelihood[w];
    double const next = log_prior[w] + log_likelihood[w];
    info.failed[w] = !std::isfinite(next);
    if (info.failed[w]) continue;
    double const log_ratio = std::isfinite(now) ? next - now : 0.0;
    info.acceptance_probability[w] = log_ratio >= 0 ? 1.0 : elementary::exp(log_ratio);
    Stream stream({key.seed, Purpose::accept, key.index + w, key.step});
    info.accepted[w] = log_ratio >= 0 || elementary::log(stream.uniform()) < log_ratio;
    if (!info.accepted[w]) continue;
    for (int p = 0; p < proposed.rows(); ++p) state.theta(p, static_cast<int>(w)) = proposed(p, static_cast<int>(w));
    state.log_prior[w] = log_prior[w];
    state.log_likelihood[w] = log_likelihood[w];
  }
  return info;
}

}  // namespace sysid::metropolis
