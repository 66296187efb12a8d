// Summaries of a fit's draws.
#include "diagnostics/convergence.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

std::vector<Summary> summarise(FitResult const& result) {
  if (!result.summaries.empty()) return result.summaries;
  std::vector<Summary> summaries;
  ConvergenceTables tables;
  for (int p = 0; p < result.draws.parameter_count; ++p) {
    auto const parameter = static_cast<std::size_t>(p);
    ChainValues values;
    if (!result.unthinned.empty()) {
      values = result.unthinned[parameter];
    } else {
      for (Chain const& chain : result.draws.chains) {
        values.emplace_back();
        for (auto const& draw : chain.values) values.back().push_back(draw[parameter]);
      }
    }
    summaries.push_back(summarise(result.draws.names[parameter], result.draws.units[parameter], values, tables));
  }
  return summaries;
}

}  // namespace sysid
