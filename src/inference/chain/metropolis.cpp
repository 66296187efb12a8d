// Metropolis-Hastings over lanes.
#include "inference/chain/metropolis.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid::metropolis {
namespace {

/// Writes what `chain` proposes into `lane`; returns whether the move is a small one.
bool propose(Proposal const& proposal, StreamKey key, ConstLanes from, int chain, Lanes to, int lane) {
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
    to(static_cast<int>(i), lane) = from(static_cast<int>(i), chain) + scale * move;
  }
  return small;
}

}  // namespace

Move decide(StreamKey key, State& state, std::size_t w, ConstLanes proposed, int lane, double log_prior, double log_likelihood,
            Odds odds) {
  Move move;
  double const now = state.log_prior[w] + odds.power * state.log_likelihood[w];
  double const next = log_prior + odds.power * log_likelihood;
  move.failed = !std::isfinite(next);
  if (move.failed) return move;
  double const log_ratio = std::isfinite(now) ? next - now + odds.log_reverse : 0.0;
  move.acceptance_probability = log_ratio >= 0 ? 1.0 : elementary::exp(log_ratio);
  Stream stream(key);
  move.accepted = log_ratio >= 0 || elementary::log(stream.uniform()) < log_ratio;
  if (!move.accepted) return move;
  for (int p = 0; p < proposed.rows(); ++p) state.theta(p, static_cast<int>(w)) = proposed(p, lane);
  state.log_prior[w] = log_prior;
  state.log_likelihood[w] = log_likelihood;
  return move;
}

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
  auto const width = static_cast<std::size_t>(state.theta.width());
  Info info(width);
  std::vector<std::uint64_t> next(width, key.step);
  advance(target, proposals, key, 1, key.step + 1, next, state, ledger,
          [&](int chain, Move const& move) { info[static_cast<std::size_t>(chain)] = move; });
  return info;
}

int cycle(Target const& target, std::span<Proposal const* const> proposals, Independence const& independence, int moves,
          StreamKey key, std::uint64_t end, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit) {
  auto const chains = static_cast<std::size_t>(state.theta.width());
  auto const iterations = static_cast<std::size_t>(std::min<std::uint64_t>(static_cast<std::uint64_t>(moves) + 1, end - key.step));
  LaneArray proposed(state.theta.rows(), static_cast<int>(chains * iterations));
  auto const key_of = [&](Purpose purpose, std::size_t w, std::size_t later) {
    return StreamKey{key.seed, purpose, key.index + w, key.step + later};
  };
  std::vector<char> small(chains);
  for (std::size_t w = 0; w < chains; ++w)
    small[w] =
        propose(*proposals[w], key_of(Purpose::proposal, w, 0), state.theta, static_cast<int>(w), proposed, static_cast<int>(w));
  auto const independent = proposed.view().columns(static_cast<int>(chains), static_cast<int>((iterations - 1) * chains));
  std::vector<StreamKey> keys;
  for (std::size_t i = 1; i < iterations; ++i)
    for (std::size_t w = 0; w < chains; ++w) keys.push_back(key_of(Purpose::proposal, w, i));
  if (iterations > 1) independence.draw(keys, independent);

  std::vector<double> log_prior(chains * iterations), log_likelihood(log_prior), here(chains), there(keys.size());
  target.log_prior(proposed, log_prior);
  target.log_likelihood(proposed, log_likelihood, ledger);
  for (std::size_t w = 0; w < chains; ++w) {
    Move move = decide(key_of(Purpose::accept, w, 0), state, w, proposed, static_cast<int>(w), log_prior[w], log_likelihood[w]);
    move.small = small[w] != 0;
    visit(static_cast<int>(w), move);
  }
  if (iterations == 1) return 1;
  independence.log_density(state.theta, here);
  independence.log_density(independent, there);
  for (std::size_t i = 1; i < iterations; ++i)
    for (std::size_t w = 0; w < chains; ++w) {
      std::size_t const lane = i * chains + w, candidate = lane - chains;
      Move move = decide(key_of(Purpose::accept, w, i), state, w, proposed, static_cast<int>(lane), log_prior[lane],
                         log_likelihood[lane], {.log_reverse = here[w] - there[candidate]});
      move.independent = true;
      if (move.accepted) here[w] = there[candidate];
      visit(static_cast<int>(w), move);
    }
  return static_cast<int>(iterations);
}

void advance(Target const& target, std::span<Proposal const* const> proposals, StreamKey key, int ahead, std::uint64_t end,
             std::span<std::uint64_t> next, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit) {
  std::vector<int> tries;
  int width = 0;
  for (std::uint64_t const iteration : next) {
    tries.push_back(iteration < end ? static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(ahead), end - iteration))
                                    : 0);
    width += tries.back();
  }
  LaneArray proposed(state.theta.rows(), width);
  std::vector<char> small(static_cast<std::size_t>(width));
  auto const key_of = [&](Purpose purpose, std::size_t w, int later) {
    return StreamKey{key.seed, purpose, key.index + w, next[w] + static_cast<std::uint64_t>(later)};
  };
  for (std::size_t w = 0, lane = 0; w < next.size(); ++w)
    for (int i = 0; i < tries[w]; ++i, ++lane)
      small[lane] = propose(*proposals[w], key_of(Purpose::proposal, w, i), state.theta, static_cast<int>(w), proposed,
                            static_cast<int>(lane));

  std::vector<double> log_prior(static_cast<std::size_t>(width)), log_likelihood(log_prior);
  target.log_prior(proposed, log_prior);
  target.log_likelihood(proposed, log_likelihood, ledger);
  for (std::size_t w = 0, first = 0; w < next.size(); first += static_cast<std::size_t>(tries[w]), ++w) {
    for (int i = 0; i < tries[w]; ++i) {
      std::size_t const lane = first + static_cast<std::size_t>(i);
      Move move =
          decide(key_of(Purpose::accept, w, 0), state, w, proposed, static_cast<int>(lane), log_prior[lane], log_likelihood[lane]);
      move.small = small[lane] != 0;
      ++next[w];
      visit(static_cast<int>(w), move);
      if (move.accepted) break;
    }
  }
}

}  // namespace sysid::metropolis
