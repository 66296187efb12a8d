// Metropolis-Hastings over lanes.
#include "inference/chain/metropolis.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/chain/candidates.hpp"

namespace sysid::metropolis {
namespace {

/// x' - x = scale L z into `lane`; returns scale^2 |z|^2.
double walk(Proposal const& proposal, Stream& stream, bool small, ConstLanes from, int chain, Lanes to, int lane) {
  double const scale = small ? proposal.small_scale * proposal.scale : proposal.scale;
  auto const dimension = static_cast<std::size_t>(proposal.dimension);
  double normals[64];
  std::vector<double> many;
  double* z = normals;
  if (dimension > std::size(normals)) {
    many.resize(dimension);
    z = many.data();
  }
  double squares = 0;
  for (std::size_t i = 0; i < dimension; ++i) {
    z[i] = stream.normal();
    squares += z[i] * z[i];
  }
  for (std::size_t i = 0; i < dimension; ++i) {
    double move = 0;
    for (std::size_t j = 0; j <= i; ++j) move += proposal.factor[i * dimension + j] * z[j];
    to(static_cast<int>(i), lane) = from(static_cast<int>(i), chain) + scale * move;
  }
  return scale * scale * squares;
}

/// Writes what `chain` proposes into candidate `lane`; returns what kind of move it is. here: the states as the mixture sees them.
Move propose(LocalMoves const& local, StreamKey key, ConstLanes from, Framed const& here, int chain, Candidates& to, int lane) {
  Stream stream(key);
  Proposal const& proposal = *local.walks[static_cast<std::size_t>(chain)];
  Move move;
  if (local.share > 0 && stream.uniform() < local.share) {
    move.kind = MoveKind::autoregressive;
    move.tunes_scale = stream.uniform() >= local.shorter;
    double const step = local.step * (move.tunes_scale ? 1 : stream.uniform());
    move.squared_jump = local.mixture->move_about(stream, step, here.x, chain, to.drawn(lane), lane);
  } else {
    bool const small = proposal.small_share > 0 && stream.uniform() < proposal.small_share;
    move.tunes_scale = !small;
    move.squared_jump = walk(proposal, stream, small, from, chain, to.theta(), lane);
  }
  return move;
}

/// The states as the mixture sees them, where local moves go about one.
Framed frame_of(Target const& target, LocalMoves const& local, State const& state) {
  return local.share > 0 ? framed(target, local.mixture->declared(), state.theta) : Framed{};
}

/// Takes or refuses candidate `lane`, a local move of chain w.
Move settle(LocalMoves const& local, Move const& proposal, StreamKey key, State& state, Framed const& here, std::size_t w,
            Candidates const& candidates, int lane) {
  Odds odds;
  if (proposal.kind == MoveKind::autoregressive) {
    Framed const& there = candidates.framed();
    odds.log_reverse = local.mixture->log_normal_density(here.x, static_cast<int>(w)) + here.log_slope[w] -
                       local.mixture->log_normal_density(there.x, lane) - there.log_slope[static_cast<std::size_t>(lane)];
  }
  Move move = decide(key, state, w, candidates.theta(), lane, candidates.log_prior(lane), candidates.log_likelihood(lane), odds);
  move.failed = move.failed && !candidates.outside(lane);
  move.tunes_scale = proposal.tunes_scale;
  move.kind = proposal.kind;
  move.squared_jump = proposal.squared_jump;
  return move;
}

/// Columns that can be simulated, for candidates of chain `chain_of(lane)`.
template <class ChainOf>
LaneArray states_of(State const& state, int width, ChainOf const& chain_of) {
  LaneArray columns(state.theta.rows(), width);
  for (int p = 0; p < columns.rows(); ++p)
    for (int lane = 0; lane < width; ++lane) columns(p, lane) = state.theta(p, chain_of(lane));
  return columns;
}

}  // namespace

double learning_gain(double best, std::uint64_t n) {
  return std::min(1.0, 1 / (best * (1 - best)) * elementary::pow(static_cast<double>(n), -0.6));
}

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

Info step(Target const& target, LocalMoves const& local, StreamKey key, State& state, Ledger& ledger) {
  auto const width = static_cast<std::size_t>(state.theta.width());
  Info info(width);
  std::vector<std::uint64_t> next(width, key.step);
  advance(target, local, key, 1, key.step + 1, next, state, ledger,
          [&](int chain, Move const& move) { info[static_cast<std::size_t>(chain)] = move; });
  return info;
}

int cycle(Target const& target, LocalMoves const& local, Independence const& independence, int moves, StreamKey key,
          std::uint64_t end, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit) {
  int const chains = state.theta.width();
  int const iterations = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(moves) + 1, end - key.step));
  auto const key_of = [&](Purpose purpose, int w, int later) {
    return StreamKey{key.seed, purpose, key.index + static_cast<std::uint64_t>(w), key.step + static_cast<std::uint64_t>(later)};
  };
  Candidates candidates(target, &independence, chains * iterations);
  Framed here = frame_of(target, local, state);
  std::vector<Move> moved;
  for (int w = 0; w < chains; ++w)
    moved.push_back(propose(local, key_of(Purpose::proposal, w, 0), state.theta, here, w, candidates, w));
  std::vector<StreamKey> keys;
  for (int i = 1; i < iterations; ++i)
    for (int w = 0; w < chains; ++w) keys.push_back(key_of(Purpose::proposal, w, i));
  int const drawn = static_cast<int>(keys.size());
  if (drawn > 0) independence.draw(keys, candidates.drawn(chains, drawn));
  candidates.evaluate(states_of(state, chains * iterations, [&](int lane) { return lane % chains; }), ledger);

  for (int w = 0; w < chains; ++w)
    visit(w, settle(local, moved[static_cast<std::size_t>(w)], key_of(Purpose::accept, w, 0), state, here,
                    static_cast<std::size_t>(w), candidates, w));
  if (iterations == 1) return 1;
  here = framed(target, independence.declared(), state.theta);
  std::vector<double> now(static_cast<std::size_t>(chains)), there(keys.size());
  independence.log_density(here.x, now);
  independence.log_density(candidates.framed().x.view().columns(chains, drawn), there);
  for (std::size_t w = 0; w < now.size(); ++w) now[w] += here.log_slope[w];
  for (std::size_t c = 0; c < there.size(); ++c) there[c] += candidates.framed().log_slope[now.size() + c];
  for (int i = 1; i < iterations; ++i)
    for (int w = 0; w < chains; ++w) {
      int const lane = i * chains + w;
      auto const chain = static_cast<std::size_t>(w), candidate = static_cast<std::size_t>(lane - chains);
      Move move = decide(key_of(Purpose::accept, w, i), state, chain, candidates.theta(), lane, candidates.log_prior(lane),
                         candidates.log_likelihood(lane), {.log_reverse = now[chain] - there[candidate]});
      move.failed = move.failed && !candidates.outside(lane);
      move.kind = MoveKind::independent;
      if (move.accepted) now[chain] = there[candidate];
      visit(w, move);
    }
  return iterations;
}

void advance(Target const& target, LocalMoves const& local, StreamKey key, int ahead, std::uint64_t end,
             std::span<std::uint64_t> next, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit) {
  std::vector<int> tries, chain_of;
  for (std::size_t w = 0; w < next.size(); ++w) {
    tries.push_back(next[w] < end ? static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(ahead), end - next[w]))
                                  : 0);
    chain_of.insert(chain_of.end(), static_cast<std::size_t>(tries.back()), static_cast<int>(w));
  }
  int const width = static_cast<int>(chain_of.size());
  Candidates candidates(target, local.mixture, width);
  Framed const here = frame_of(target, local, state);
  std::vector<Move> moved;
  auto const key_of = [&](Purpose purpose, std::size_t w, int later) {
    return StreamKey{key.seed, purpose, key.index + w, next[w] + static_cast<std::uint64_t>(later)};
  };
  for (std::size_t w = 0; w < next.size(); ++w)
    for (int i = 0; i < tries[w]; ++i)
      moved.push_back(propose(local, key_of(Purpose::proposal, w, i), state.theta, here, static_cast<int>(w), candidates,
                              static_cast<int>(moved.size())));
  candidates.evaluate(states_of(state, width, [&](int lane) { return chain_of[static_cast<std::size_t>(lane)]; }), ledger);
  for (std::size_t w = 0, first = 0; w < next.size(); first += static_cast<std::size_t>(tries[w]), ++w) {
    for (int i = 0; i < tries[w]; ++i) {
      std::size_t const lane = first + static_cast<std::size_t>(i);
      Move const move =
          settle(local, moved[lane], key_of(Purpose::accept, w, 0), state, here, w, candidates, static_cast<int>(lane));
      ++next[w];
      visit(static_cast<int>(w), move);
      if (move.accepted) break;
    }
  }
}

}  // namespace sysid::metropolis
