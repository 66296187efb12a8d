// The rules that end a run, and the reason that is reported.
#pragma once
#include <optional>
#include <string>

#include "inference/abc/plan.hpp"
#include "inference/abc/state.hpp"

namespace sysid::abc {

struct Stop {
  std::string why;       // in words
  bool ran_out = false;  // a budget ended it, not its own rule
};

/// Whether the last whole population is the run's last: by its threshold, its acceptance, or its number.
std::optional<Stop> end_after_population(State const& state, Plan const& plan);

/// Whether the population in the making is given up, after so many seconds of the run.
std::optional<Stop> end_within_population(State const& state, Plan const& plan, double seconds);

}  // namespace sysid::abc
