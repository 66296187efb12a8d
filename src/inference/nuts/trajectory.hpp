// A Hamiltonian trajectory that doubles until it turns back: the no-U-turn sampler, one leapfrog step at a time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/numeric/random.hpp"
#include "inference/nuts/metric.hpp"

namespace sysid::nuts {

/// A state and what is known of the log density there.
struct Point {
  std::vector<double> theta;     // [P]
  std::vector<double> gradient;  // [P], of the log density
  double log_prior = 0, log_likelihood = 0;
  double log_density() const { return log_prior + log_likelihood; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(theta), visitor(gradient), visitor(log_prior), visitor(log_likelihood);
  }
};

/// A point with its momentum [P], in units of the metric.
struct Phase {
  Point at;
  std::vector<double> momentum;

  double energy() const;
  template <class Visitor>
  void visit(Visitor& visitor) {
    at.visit(visitor), visitor(momentum);
  }
};

/// A leapfrog step in two halves, between which the log density is looked up at `theta`:
///
///   r' = r + step/2 L^T g(theta),   theta' = theta + step L r',   r'' = r' + step/2 L^T g(theta')
///
/// with the gradient g of the log density and the metric's factor L. The error of the energy over a given time is of order step^2.
struct HalfStep {
  std::vector<double> theta, momentum;  // theta', r'
  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(theta), visitor(momentum);
  }
};
HalfStep begin_step(Phase const& from, Metric const& metric, double step);
/// at: what is known of begun.theta.
Phase end_step(HalfStep const& begun, Point at, Metric const& metric, double step);

/// What a trajectory was like: what only adaptation and diagnostics need.
struct TrajectoryInfo {
  double acceptance = 0;  // mean over its states of min(1, exp(H(start) - H))
  int leapfrogs = 0;
  bool moved = false;         // the draw is not the start
  bool diverged = false;      // the energy rose by more than 1000: the steps do not follow the density there
  bool unsolved = false;      // where it diverged the density is not finite
  bool cut = false;           // still going straight at the last doubling that is allowed
  std::vector<double> place;  // [P] where the step that diverged began; else empty
};

/// One iteration of multinomial NUTS (Hoffman and Gelman 2014; Betancourt 2017, app. A). From `start` with a normal momentum,
/// leapfrog steps are made forwards or backwards, at random, as many as have been made before, until the trajectory, or one of the
/// halves that it was put together from, turns back: until for the ends a and b of a part, and the sum s of its momenta,
///
///   s . r_a <= 0 or s . r_b <= 0                                                                         Betancourt 2017, app. A
///
/// The same is asked of each half with the first state of the other, which catches trajectories whose halves end where they began
/// (Stan reference manual, 2.21). The draw is a state of the trajectory, with probability in proportion to exp(-H): uniformly
/// within a new half, between halves with preference for the new one (Betancourt 2017, app. A). A half that turns back or diverges
/// within itself is not drawn from.
///
/// Where the log density and its gradient are needed next is `asked`; `take` goes on from what they are there. Any gradient that
/// depends on theta alone leaves the density as it is, since a leapfrog step with it preserves volume and can be reversed; an
/// inaccurate one costs acceptance.
class Trajectory {
 public:
  Trajectory() = default;
  /// key: names the random numbers of this iteration. most_doublings: >= 1.
  Trajectory(StreamKey key, Point start, Metric const& metric, double step, int most_doublings);

  bool done() const { return done_; }
  std::vector<double> const& asked() const { return begun_.theta; }
  /// at: of the theta that was asked.
  void take(Point at, Metric const& metric);

  Point const& draw() const { return draw_; }
  TrajectoryInfo info() const;

  template <class Visitor>
  void visit(Visitor& visitor) {
    backward_.visit(visitor), forward_.visit(visitor), visitor(sum_), visitor(log_weight_), draw_.visit(visitor);
    visitor(depth_), visitor(most_doublings_), visitor(is_forward_), visitor(step_), visitor(start_energy_);
    auto parts = static_cast<int>(half_.size());
    visitor(parts);
    half_.resize(static_cast<std::size_t>(std::min(parts, most_parts)));  // more: a damaged checkpoint, which then differs in form
    for (Part& part : half_) part.visit(visitor);
    front_.visit(visitor), begun_.visit(visitor);
    visitor(acceptance_), visitor(leapfrogs_), visitor(uniforms_);
    visitor(moved_), visitor(diverged_), visitor(unsolved_), visitor(cut_), visitor(done_);
  }
  /// After a visit that restored it: the stream goes on where it was. Throws checkpoint::Mismatch where vectors have not P numbers.
  void resume(StreamKey key, int dimension);

 private:
  static constexpr int most_parts = 64;
  /// 2^depth states in a row, in the order in which they were reached.
  struct Part {
    int depth = 0;
    std::vector<double> first, last, sum;  // momenta of its ends, and of all states
    double log_weight = 0;                 // log of the sum of exp(H(start) - H)
    Point draw;
    template <class Visitor>
    void visit(Visitor& visitor) {
      visitor(depth), visitor(first), visitor(last), visitor(sum), visitor(log_weight), draw.visit(visitor);
    }
  };

  double uniform();
  double directed_step() const { return is_forward_ ? step_ : -step_; }
  void begin_half(Metric const& metric);
  bool join_parts();
  bool join_half();

  Phase backward_, forward_;  // the ends
  std::vector<double> sum_;
  double log_weight_ = 0;
  Point draw_;
  int depth_ = 0, most_doublings_ = 0;
  bool is_forward_ = true;  // the half under way
  double step_ = 0, start_energy_ = 0;
  std::vector<Part> half_;  // the half under way: parts of falling depth
  Phase front_;             // its newest state
  HalfStep begun_;
  double acceptance_ = 0;
  int leapfrogs_ = 0, uniforms_ = 0;
  bool moved_ = false, diverged_ = false, unsolved_ = false, cut_ = false, done_ = false;
  Stream stream_{StreamKey{}};
};

}  // namespace sysid::nuts
