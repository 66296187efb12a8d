// Rules and budgets.
#include "inference/abc/stops.hpp"

#include <fmt/format.h>

namespace sysid::abc {
namespace {

/// A population that finds nothing in so many proposals will not find enough.
constexpr std::uint64_t patience = 1'000'000;

/// Proposals outside of the prior's support cost no simulation, and yet must end.
constexpr double proposals_per_simulation = 100;

}  // namespace

std::optional<Stop> end_after_population(State const& state, Plan const& plan) {
  Population const &last = state.last, &next = state.next;
  if (last.number == 0) return std::nullopt;
  double const fall = last.threshold - next.threshold;
  if (!plan.schedule.empty()) {
    if (static_cast<std::size_t>(last.number) >= plan.schedule.size()) return Stop{"all thresholds of the schedule are used"};
  } else if (last.threshold <= plan.target) {
    return Stop{fmt::format("the threshold has reached the target {}", plan.target)};
  } else if (fall <= plan.threshold_change) {
    return Stop{
        fmt::format("the threshold would next decrease by only {:.2g}; a decrease of at most {} (`threshold_change`) ends the run",
                    fall, plan.threshold_change)};
  } else if (fall <= plan.relative_change * next.threshold) {
    return Stop{fmt::format(
        "the threshold would next decrease by only {:.2g} %; a decrease of at most {} % (`relative_change`) ends the run",
        100 * fall / next.threshold, 100 * plan.relative_change)};
  }
  if (double const accepted = state.records.back().acceptance(); accepted < plan.acceptance)
    return Stop{fmt::format("the acceptance rate of the proposals is {:.2g}, below {}", accepted, plan.acceptance)};
  if (last.number >= plan.populations) return Stop{fmt::format("`populations = {}` is reached", plan.populations)};
  return std::nullopt;
}

std::optional<Stop> end_within_population(State const& state, Plan const& plan, double seconds) {
  PopulationRecord const& record = state.record;
  auto const proposed = static_cast<double>(record.proposed);
  if (state.simulations() + record.simulated >= plan.simulations)
    return Stop{fmt::format("`simulations = {}` is reached", plan.simulations), true};
  if (proposed >= proposals_per_simulation * static_cast<double>(plan.simulations))
    return Stop{fmt::format("{} proposals, most of them outside the priors, have not filled population {}", record.proposed,
                            state.next.number),
                true};
  if (plan.wall_time > 0 && seconds > plan.wall_time) return Stop{fmt::format("`wall_time = {}` is reached", plan.wall_time), true};
  if (record.accepted == 0 && record.proposed >= patience)
    return Stop{fmt::format("population {} accepted none of {} proposals", state.next.number, record.proposed), true};
  // So many proposals fill a population at that rate, and this one is not full.
  if (plan.acceptance * proposed >= plan.particles)
    return Stop{fmt::format("fewer than {} of the proposals of population {} were accepted", plan.acceptance, state.next.number)};
  return std::nullopt;
}

}  // namespace sysid::abc
