// Where local searches from the prior begin, and how many of them there are.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "likelihood/target.hpp"
#include "search/descent.hpp"
#include "search/objective.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// How much a search looks at: of which draws it asks the density, and how many of them it climbs from.
struct Breadth {
  int draws;
  std::size_t likeliest, others, finalists;
  int rounds;  // of the finalists, before they are settled; of a target that has a gradient, evaluations
};

/// By what a value of the target costs.
Breadth const& breadth_of(Target const& target);

/// Whether an equation holds an unknown function, whose coefficients are parameters.
bool has_coefficients(Target const& target);

/// What one round of one local search costs: derivatives, and the steps that are tried.
std::uint64_t simulations_per_round(Target const& target);

LaneArray draw_prior(Target const& target, StreamKey key, int count);

/// Coefficients of unknown functions at zero, where a model is what it is without them.
void begin_without_functions(Target const& target, LaneArray& draws);

/// The draws worth a local search: the likeliest, and the first of the rest.
std::vector<Climber> choose_starts(Objective const& objective, ConstLanes draws, Breadth const& breadth, Ledger& ledger,
                                   std::function<bool()> const& stop, Journal* journal);

/// Where local searches may begin beside the places that earlier ones, on fewer rows, have come to.
enum class Further {
  none,
  pulled,  // at prior draws that are pulled onto these places
  all,     // at prior draws as they are, too
};

constexpr int fresh_draws = 64;

/// As many starts as `breadth` at most. The best half of `from`, at least one, in any case, with their hits; then the likeliest of
/// the rest of them and of what else is allowed: four times as many pulled draws as starts, where a place leaves a direction loose,
/// and 64 prior draws, of which no more than a quarter of the starts are taken. from: best first.
std::vector<Climber> starts_from(Objective const& objective, std::vector<Climber> const& from, std::size_t breadth, Further further,
                                 StreamKey key, Ledger& ledger, std::function<bool()> const& stop, Journal* journal);

}  // namespace sysid
