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
    ChainValues const values = result.unthinned.empty() ? chains_of(result.draws, parameter) : result.unthinned[parameter];
    summaries.push_back(summarise(result.draws.names[parameter], result.draws.units[parameter], values, tables));
  }
  return summaries;
}

}  // namespace sysid
