// One chain of the no-U-turn sampler between two leapfrog steps: where it stands, the trajectory under way, what it has learnt.
#pragma once
#include <cstdint>
#include <vector>

#include "inference/nuts/metric.hpp"
#include "inference/nuts/step_size.hpp"
#include "inference/nuts/trajectory.hpp"

namespace sysid::nuts {

/// Iterations of burn-in: the step is learnt in all of them, the metric in windows. The first 15 % (at most 75) lead to the
/// posterior and the last 10 % (at most 50) settle the step; between them each window has twice the iterations of the one before,
/// the first 25. From 500 iterations on this is Stan's plan; for fewer, Stan takes 75 and 50 as long as they fit.
struct BurnIn {
  std::uint64_t length = 0, first = 0;  // iterations; the first of the first window
  std::vector<std::uint64_t> ends;      // of the windows, rising
};
BurnIn plan_burn_in(std::uint64_t length);

/// What the trajectories after burn-in were like.
struct Tally {
  std::uint64_t trajectories = 0, diverged = 0, unsolved = 0, cut = 0;
  std::vector<double> places;  // [P] each, of the first `most_places` that diverged

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(trajectories), visitor(diverged), visitor(unsolved), visitor(cut), visitor(places);
  }
};

/// A chain learns from its own states alone: its draws depend on the seed, its number and its start.
class Chain {
 public:
  Chain() = default;
  /// key: of the chain, at iteration 0. acceptance: what the step is tuned to.
  Chain(StreamKey key, Point start, Metric metric, double acceptance, int most_doublings);

  /// Where the log density and its gradient are needed.
  std::vector<double> const& asked() const { return trajectory_.asked(); }
  /// One leapfrog step; true where it ended an iteration, of which `at` is the draw and `last` says what it was like.
  bool take(Point at, BurnIn const& burn_in);

  std::uint64_t iterations() const { return iterations_; }
  Point const& at() const { return at_; }
  TrajectoryInfo const& last() const { return last_; }
  Tally const& tally() const { return tally_; }
  Metric const& metric() const { return metric_; }
  double step() const { return step_.step(); }

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(iterations_), visitor(most_doublings_), at_.visit(visitor), metric_.visit(visitor), step_.visit(visitor);
    window_.visit(visitor), trajectory_.visit(visitor), tally_.visit(visitor);
  }
  /// After a visit that restored it. Throws checkpoint::Mismatch where it is not of P dimensions.
  void resume(StreamKey key, int dimension);

 private:
  void learn(BurnIn const& burn_in);
  void count();
  void begin();

  StreamKey key_;
  std::uint64_t iterations_ = 0;
  int most_doublings_ = 10;
  Point at_;
  Metric metric_;
  StepSize step_;
  WindowOfDraws window_;
  Trajectory trajectory_;
  TrajectoryInfo last_;
  Tally tally_;
};

}  // namespace sysid::nuts
