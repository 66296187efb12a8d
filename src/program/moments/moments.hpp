// States that are random given the parameters: their mean and covariance as the states of a program, moved by a method like any
// other and corrected at every sample that is observed. What comes out is the filter of Kalman, exact for linear models, or one of
// its approximations; lanes, machine code and derivatives need to know nothing of it.
#pragma once
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "program/moments/moment_passage.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// What is random in the states of a source: initial values, and white noise, leaves disturbance(i), that derivatives (the next
/// values of a map) read linearly.
struct RandomStates {
  struct Noise {
    NodeId intensity = 0;  // q of its autocovariance q*delta(t); of a map, and if `held`, the variance
    // One value from sample to sample. Exact methods step it so; to others it is white, of intensity variance * sampling interval.
    bool held = false;
  };
  std::vector<Noise> noises;
  std::vector<std::optional<NodeId>> initial_variances;  // per state; absent: the initial value is known
  /// The state whose column of the Cholesky factor comes first, those after it next, then those before: where the covariance is
  /// nearly singular, states that determine others come before them.
  int first_column = 0;
  /// Where a step has slopes F, and V is what the noise adds, P <- F P F' + V takes the place of the equation of P: with an exact
  /// method, and for up to three states with other fixed steps where an extended filter meets them. So a step that is too long
  /// gives no negative variance. An exact method and a linear map move not P itself but U and D of P = U D U', U with ones on and
  /// zeros below its diagonal, D diagonal: nothing is subtracted from D, and little is lost where a start is hardly known and a
  /// sensor is precise.
  bool by_slopes = false;
};

/// A channel with normal noise: expressions of states, inputs, time and parameters.
struct NormalChannel {
  NodeId mean = 0, variance = 0;
};

/// What a filter expects of a sample, given the samples before it and those of earlier channels, and what the states become.
struct Innovation {
  NodeId mean = 0, variance = 0;  // of the sample
  std::vector<NodeId> correct;    // for ChannelSource::correct
};

/// Further states that say how the states now vary together with what was at the last sample: what smoothing needs.
struct SincePastSample {
  /// [n x n] covariance of state i now with state j at the last sample, given the samples up to that.
  std::vector<NodeId> states;
  /// [noises x n] covariance of the noise, summed up since the last sample, with state i now; and its variance [noises].
  std::vector<NodeId> noises, sums;
  std::vector<NodeId> begin;  // ChannelSource::correct of a channel behind all others and of all samples: from here on anew
};

struct Moments {
  /// Of the means, states 0 ... n - 1, then of those covariances that may differ from 0, then of those of `since`; no channels and
  /// records yet.
  SimulationSource source;
  std::vector<Innovation> channels;
  /// [n x n] the covariance of two states, an expression of the states of `source`.
  std::vector<NodeId> covariance;
  NodeId of(int i, int j) const { return covariance[static_cast<std::size_t>(i) * means + static_cast<std::size_t>(j)]; }
  std::size_t means = 0;
  /// Behind the means: the entries (i, j), j <= i, of the covariance that are states; where it is `factored`, D at i = j and the
  /// entry (j, i) of U elsewhere.
  std::vector<std::pair<int, int>> entries;
  bool factored = false;
  std::optional<SincePastSample> since;
};

/// Between samples, with A = df/dx and G = df/dw at the mean m,
///   m' = f(m),  P' = A P + P A' + G Q G'                                            Jazwinski 1970, eq. 9.56 and 9.57
/// or, from sigma points, m' = E f(x), P' = cov(x, f) + cov(f, x) + G Q G'            Sarkka 2007, eq. 34 and 35
/// and of a map m <- f(m), P <- A P A' + G Q G'. A sample y with mean h and noise variance R corrects by, with H = dh/dx,
///   S = H P H' + R,  m <- m + P H' (y - h)/S,  P <- P - P H' H P/S
/// channel after channel, which is the same as all at once because their noises are independent. A gain that reads states adds to
/// f_i half of sum_k q (dG_i/dx_k) G_k (Stratonovich); an R that does is taken at the mean.
///
/// With `since`, C = cov(x, x at the last sample) and u = cov(x, integral of w) beside them, C = P and u = 0 after a sample:
///   C' = A C,  u' = A u + G q         and of a map C <- cov(f(x), x), u <- G q
/// where from sigma points A stands for cov(f, x) P^-1, by which also P moves; C and u lie in the range of P, which may be
/// singular.
///
/// An exact method (SolverRow::exact) makes a map of all this, with exp(hA) and what noise adds over a step
/// (solver/exact_moments.hpp). A method with fixed steps makes one of few states, whose F are the slopes of the step itself and
/// whose V that of its answers to noise that is a straight line over the step. Factored, P <- F P F' + V comes from the rows of (F
/// U | factor of V) by Gram and Schmidt (Thornton 1976), corrections are those of Bierman 1977, ch. V.
///
/// dynamics: without channels, records, memories and constraints.
Moments with_moments(SimulationSource dynamics, RandomStates const& random, std::span<NormalChannel const> channels,
                     MomentRule rule, bool since = false);

}  // namespace sysid
