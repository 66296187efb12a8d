// Only few failures are run again one by one, because that is slow.
#include "likelihood/failures.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

constexpr std::uint64_t traced_failures = 8;  // per ledger

}  // namespace

void record_failures(SolvedBatch const& batch, std::span<Outcome const> outcome, Describe const& describe,
                     std::function<std::vector<double>(int lane)> const& example, Ledger& ledger) {
  Schedule const& schedule = batch.simulator.schedule();
  ledger.add_solves(outcome.size());
  for (std::size_t w = 0; w < outcome.size(); ++w) {
    if (outcome[w].ok) continue;
    int const lane = static_cast<int>(w);
    double const by = schedule.time(std::max(outcome[w].sample, 0));
    if (ledger.failed() >= traced_failures) {
      ledger.add_failure(outcome[w].kind, Ledger::untraced, by, example(lane));
      continue;
    }
    std::vector<double> column;
    for (int p = 0; p < batch.parameters.rows(); ++p) column.push_back(batch.parameters(p, lane));
    // A start that no iteration found is not a number (StartState), whatever follows.
    if (batch.start_estimated && std::isnan(column.back())) {
      ledger.add_failure(FailureClass::convergence, "the estimated start" + batch.on, schedule.time(0), example(lane));
      continue;
    }
    auto const found = batch.simulator.diagnose(column);
    std::string const where = !found     ? std::string("a sum over the samples")
                              : describe ? describe(found->node, batch.simulator.program().source.graph)
                                         : std::string("the model");
    ledger.add_failure(found ? found->kind : outcome[w].kind, where + batch.on, found ? found->time : by, example(lane));
  }
}

void all_or_nothing(Ledger& ledger, std::function<void()> const& record) {
  if (ledger.failed() >= traced_failures) return record();  // none is run again
  Ledger before = ledger;
  try {
    record();
  } catch (...) {
    ledger = std::move(before);
    throw;
  }
}

}  // namespace sysid
