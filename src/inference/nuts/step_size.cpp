// Dual averaging.
#include "inference/nuts/step_size.hpp"

#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid::nuts {
namespace {

constexpr double gamma = 0.05, first_iterations = 10, kappa = 0.75;

}  // namespace

// Beskos, Pillai, Roberts, Sanz-Serna and Stuart 2013: the error of the energy over a trajectory grows with P step^4.
StepSize::StepSize(int dimension, double target)
    : target_(target), first_(elementary::pow(static_cast<double>(dimension), -0.25)), step_(first_) {}

void StepSize::learn(double acceptance) {
  ++count_;
  auto const t = static_cast<double>(count_);
  double const gain = 1 / (t + first_iterations);
  shortfall_ = (1 - gain) * shortfall_ + gain * (target_ - acceptance);
  double const log_step = elementary::log(first_) - std::sqrt(t) / gamma * shortfall_;
  double const weight = elementary::pow(t, -kappa);
  log_average_ = weight * log_step + (1 - weight) * log_average_;
  step_ = elementary::exp(log_step);
}

void StepSize::restart() {
  step_ = first_;
  log_average_ = shortfall_ = 0;
  count_ = 0;
}

void StepSize::freeze() {
  if (count_ > 0) step_ = elementary::exp(log_average_);
}

}  // namespace sysid::nuts
