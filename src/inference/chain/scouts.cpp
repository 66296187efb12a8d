// The walk of the scouts.
#include "inference/chain/scouts.hpp"

#include <utility>

#include "inference/evidence/ensemble_walk.hpp"

namespace sysid::metropolis {
namespace {

constexpr std::uint64_t first_step = 20'000'000, step_count = 100'000;  // of Purpose::start; more than a walk takes

int steps_out(int dimension) { return marginal::long_walk(dimension) / 2; }
int steps_back(int dimension) { return marginal::long_walk(dimension); }

}  // namespace

std::uint64_t cost_of_scouts(int dimension) {
  return static_cast<std::uint64_t>(scouts) * static_cast<std::uint64_t>(steps_out(dimension) + steps_back(dimension) + 5);
}

LaneArray scout(Objective const& objective, LaneArray from, std::uint64_t seed, std::uint64_t round, Ledger& ledger) {
  auto const never = [] { return false; };
  int const dimension = objective.dimension();
  StreamKey const key{seed, Purpose::start, 0, first_step + 2 * round * step_count};
  LaneArray const spread =
      marginal::walk(objective, std::move(from), steps_out(dimension), key, ledger, never, marginal::spreading_power);
  LaneArray const last(spread.view().columns(spread.width() / 3 * 2, spread.width() / 3));
  return marginal::walk(objective, last, steps_back(dimension), key.with_step(key.step + step_count), ledger, never);
}

}  // namespace sysid::metropolis
