// The coordinates in which particles move.
#pragma once
#include <vector>

#include "inference/abc/plan.hpp"
#include "likelihood/selection/selection_target.hpp"

namespace sysid::abc {

/// x of each model, from plan.coordinates:
///   natural         logarithms of parameters whose prior spans decades, declared values of the others
///   declared        declared values
///   unconstrained   the sampler's coordinates
class Walk {
 public:
  Walk(SelectionTarget const& candidates, Plan const& plan);

  // theta, declared, x: [D x W] of the model; NaN or infinite where a place is outside of what the other can say.
  void from_theta(int model, ConstLanes theta, Lanes x) const;
  void to_theta(int model, ConstLanes x, Lanes theta) const;
  void to_declared(int model, ConstLanes x, Lanes declared) const;
  /// The prior's density over x. theta: to_theta of x. out: [W].
  void log_prior(int model, ConstLanes x, ConstLanes theta, std::span<double> out) const;

 private:
  SelectionTarget const& candidates_;
  bool unconstrained_;
  std::vector<std::vector<int>> logarithmic_;  // per model: rows
};

}  // namespace sysid::abc
