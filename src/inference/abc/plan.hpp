// The plan of an ABC-SMC run, read once from its settings.
#pragma once
#include <cstdint>
#include <vector>

#include "core/setting/settings.hpp"

namespace sysid::abc {

struct KernelRow;

/// Walk says what they are.
enum class Coordinates { natural, declared, unconstrained };

struct Plan {
  int particles = 1000;
  double quantile = 0.2;
  std::vector<double> schedule;  // of thresholds; empty: by quantile
  double first_threshold = 0;    // infinite: every simulation that ends is accepted
  KernelRow const* kernel = nullptr;
  double scale = 2;  // of the kernel: of a covariance, or a width in ranges
  int neighbours = 50;
  Coordinates coordinates = Coordinates::natural;
  bool from_previous = false;     // models are drawn from the last population and moved by a kernel; else from the prior
  double stay = 0.7;              // of that kernel
  double threshold_change = 0;    // stop at such a fall of the threshold, absolute
  double relative_change = 0.01;  // or as a part of the threshold
  double target = 0;              // stop at this threshold
  double acceptance = 0;          // stop below this acceptance rate
  std::uint64_t simulations = 0;  // stop after so many in all
  double wall_time = 0;           // [s]; 0: no limit
  int populations = 100;
};

Plan plan_of(Settings const& settings);

}  // namespace sysid::abc
