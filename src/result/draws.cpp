// Draws spread over chains.
#include "result/draws.hpp"

#include <algorithm>

namespace sysid {

std::vector<double> Draws::column(std::size_t name) const {
  std::vector<double> out;
  out.reserve(total());
  for (Chain const& chain : chains)
    for (std::vector<double> const& row : chain.values) out.push_back(row[name]);
  return out;
}

Draws::Best Draws::best() const {
  Best best;
  for (Chain const& chain : chains)
    for (std::size_t d = 0; d < chain.values.size(); ++d)
      if (best.values == nullptr || chain.log_density[d] > best.log_density) best = {&chain.values[d], chain.log_density[d]};
  return best;
}

LaneArray spread(Draws const& draws, int count) {
  return spread_with_repeats(draws, std::min<int>(count, static_cast<int>(draws.total())));
}

LaneArray spread_with_repeats(Draws const& draws, int count) {
  std::vector<std::vector<double> const*> pooled;
  for (Chain const& chain : draws.chains)
    for (auto const& values : chain.values) pooled.push_back(&values);
  LaneArray columns(draws.parameter_count, count);
  for (int w = 0; w < count; ++w) {
    auto const pick = static_cast<std::size_t>((2LL * w + 1) * static_cast<long long>(pooled.size()) / (2LL * count));
    for (int p = 0; p < draws.parameter_count; ++p) columns(p, w) = (*pooled[pick])[static_cast<std::size_t>(p)];
  }
  return columns;
}

}  // namespace sysid
