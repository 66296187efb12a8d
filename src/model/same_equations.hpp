// Whether two models have the same equations under different names.
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "model/model.hpp"

namespace sysid {

/// How two models with the same equations differ.
struct Likeness {
  std::vector<std::pair<int, int>> parameters;  // that stand in each other's place, by index
  bool same_names = true;                       // of these
  bool same_priors = true;
};

/// Of two models that have the same states in the same order, the same channels and inputs by name, and the same equations, initial
/// values and noise but for the names of parameters and states; else nothing. A parameter that is sampled in one must be sampled in
/// the other, and fixed ones have equal values. What is not compared (unknown functions, implicit equations) counts as different,
/// and so do equations that only algebra makes equal.
std::optional<Likeness> same_equations(Model const& one, Model const& other);

}  // namespace sysid
