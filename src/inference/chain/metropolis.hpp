// Metropolis-Hastings moves of W chains in lanes: random walks with a Gaussian proposal, autoregressive and independence moves.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "core/system/ledger.hpp"
#include "inference/chain/independence.hpp"
#include "likelihood/target.hpp"

namespace sysid::metropolis {

/// x' = x + s L z with z ~ N(0, I). With probability `small_share` s is `small_scale` times `scale`: such moves get a chain out of
/// narrow places that the full scale never leaves. Symmetric in x and x' either way, so its density cancels from the acceptance
/// ratio.
struct Proposal {
  int dimension = 0;
  std::vector<double> factor;  // L, lower triangle of [P x P] by rows
  double scale = 1;
  double small_share = 0;
  double small_scale = 0.2;
};

/// What the scales of moves that start from where a chain stands are tuned to.            Roberts, Gelman and Gilks 1997
inline constexpr double best_acceptance = 0.234;

/// What an acceptance beyond the best moves the logarithm of a step by, as a part of what it is beyond, the n-th time that it is
/// learnt:
///
///   min(1, n^-0.6 / (a (1 - a))),   a the best acceptance
///
/// 1 / (a (1 - a)) is optimal in one dimension (Garthwaite, Fan and Sisson 2016); n^-0.6 lets it settle.
double learning_gain(double best, std::uint64_t n);

/// Moves from where a chain stands: random walks, and in `share` of them, drawn by chance, autoregressive moves about a mixture.
/// Either kind leaves the posterior as it is, so a fixed mixture of them does.
struct LocalMoves {
  std::span<Proposal const* const> walks;  // [W]
  Independence const* mixture = nullptr;   // about whose normal parts autoregressive moves go
  double step = 1;                         // of these, in (0, 1]
  double share = 0;                        // of these in all
  /// Of autoregressive moves, those with a part of the step, uniform and drawn anew each time: they lead out of tails that the
  /// normal distribution hardly reaches, where longer ones are refused.
  double shorter = 0.5;
};

/// N(x, variance I), as (8.17) of the tutorial that docs/methods/sources.md names first.
Proposal spherical(int dimension, double variance);

/// What the next step needs, and a checkpoint holds.
struct State {
  LaneArray theta;                     // [P x W]
  std::vector<double> log_prior;       // [W], density on R^P
  std::vector<double> log_likelihood;  // [W]
};

enum class MoveKind { walk, autoregressive, independent, ridge };

/// What one chain did in one iteration: what only adaptation and diagnostics need.
struct Move {
  double acceptance_probability = 0;  // 0 where the proposal failed
  bool accepted = false;
  bool failed = false;      // the proposal's density was not finite; such a move must not steer adaptation
  bool tunes_scale = true;  // it was of the length that adaptation tunes
  MoveKind kind = MoveKind::walk;
  double squared_jump = 0;  // of a walk or an autoregressive move, taken or refused, over the proposal's covariance
};
using Info = std::vector<Move>;  // [W]

/// What a move is accepted by, besides the densities.
struct Odds {
  double log_reverse = 0;  // log of the density of proposing the way back, over that of the way there
  double power = 1;        // of the likelihood
};

/// Takes or refuses column `lane` of `proposed`, of these log densities, for chain w; `key` names the uniform number.
Move decide(StreamKey key, State& state, std::size_t w, ConstLanes proposed, int lane, double log_prior, double log_likelihood,
            Odds odds = {});

/// Evaluates theta [P x W].
State init(Target const& target, LaneArray theta, Ledger& ledger);

/// One local move of every chain. Chain w of the block is chain key.index + w of the run, key.step is the iteration: its numbers,
/// and so its path, do not depend on the other lanes.
///
///   accept a walk with probability min(1, p(x') / p(x))   the tutorial's Sec. 8.3 prints the ratio upside down; Hastings 1970
///
/// A state whose own density is not finite accepts any proposal whose density is.
Info step(Target const& target, LocalMoves const& local, StreamKey key, State& state, Ledger& ledger);

/// A cycle of every chain from one batch: one local move, then `moves` independence moves, fewer where iteration `end`
/// is reached. Candidates of independence moves do not depend on where a chain stands, so that none is evaluated in vain:
///
///   accept x' with probability min(1, p(x') q(x) / (p(x) q(x')))                                     Hastings 1970; Tierney 1994
///
/// All chains are at iteration key.step, and take each iteration together: `visit(chain, move)` is called for all of them, in
/// order, before the next. Each kind of move leaves the posterior as it is, so a cycle of them does. Returns the iterations taken.
int cycle(Target const& target, LocalMoves const& local, Independence const& independence, int moves, StreamKey key,
          std::uint64_t end, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit);

/// Several local moves of each chain from one batch, for proposals that do not change: chain w tries its moves of iterations
/// next[w], next[w] + 1, ... (`ahead` of them, none at `end` or later) all from where it stands, and takes them in turn up to the
/// first accepted one; the others started from a place it has left and are dropped. `next` moves on by the iterations taken;
/// `visit(chain, move)` is called after each, in order, with the state as it is then. Path and draws are those of `step` after
/// `step`: most moves are rejected, so idle lanes that guess "rejected" are right most of the time (Brockwell 2006, pre-fetching).
void advance(Target const& target, LocalMoves const& local, StreamKey key, int ahead, std::uint64_t end,
             std::span<std::uint64_t> next, State& state, Ledger& ledger, std::function<void(int, Move const&)> const& visit);

}  // namespace sysid::metropolis
