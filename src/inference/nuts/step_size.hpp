// The size of leapfrog steps, learnt in burn-in by dual averaging.
#pragma once
#include <cstdint>

namespace sysid::nuts {

/// Hoffman and Gelman 2014, (6) and sec. 3.2: after iteration t with acceptance a_t
///
///   H_t = (1 - 1/(t + t0)) H_(t-1) + (target - a_t)/(t + t0)
///   log step_t = mu - sqrt(t)/gamma H_t,    log average_t = t^-kappa log step_t + (1 - t^-kappa) log average_(t-1)
///
/// with gamma = 0.05, t0 = 10, kappa = 0.75. mu is not log(10 step), as there, but the logarithm of the step that suits a normal
/// density whose covariance is the metric: its scale is known before the first step.
class StepSize {
 public:
  StepSize() = default;
  StepSize(int dimension, double target);

  void learn(double acceptance);
  double step() const { return step_; }
  /// Learns anew, for another metric.
  void restart();
  /// The average from here on.
  void freeze();

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(target_), visitor(first_), visitor(step_), visitor(log_average_), visitor(shortfall_), visitor(count_);
  }

 private:
  double target_ = 0.8, first_ = 1, step_ = 1, log_average_ = 0, shortfall_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace sysid::nuts
