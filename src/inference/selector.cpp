// The selecting back ends, one line each, in the order `sysid list` prints them; and what weighted particles have in common.
#include "inference/selector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/table.hpp"
#include "inference/abc/abc_smc.hpp"
#include "inference/abc/settings.hpp"

namespace sysid {
namespace {

SelectorRow const selector_rows[] = {
    {"abc_smc", "approximate Bayesian computation by populations of particles, over models and parameters", abc::settings(),
     &abc::refuse, &abc::run},
};

}  // namespace

std::span<SelectorRow const> selectors() { return selector_rows; }

SelectorRow const* find_selector(std::string_view name) { return row_named(selector_rows, name); }

double PopulationRecord::share(int model) const {
  return accepted == 0 ? 0 : static_cast<double>(models[static_cast<std::size_t>(model)].particles) / accepted;
}

double PopulationRecord::acceptance() const {
  return proposed == 0 ? 1 : static_cast<double>(accepted) / static_cast<double>(proposed);
}

WeightedSummary summarise_weighted(std::string name, std::string unit, std::span<double const> values,
                                   std::span<double const> weights) {
  WeightedSummary summary{std::move(name), std::move(unit)};
  for (std::size_t i = 0; i < values.size(); ++i) summary.mean += weights[i] * values[i];
  double variance = 0;
  for (std::size_t i = 0; i < values.size(); ++i) variance += weights[i] * (values[i] - summary.mean) * (values[i] - summary.mean);
  summary.sd = std::sqrt(variance);
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  auto const quantile = [&](double probability) {
    double below = 0;
    for (std::size_t const i : order) {
      below += weights[i];
      if (below >= probability) return values[i];
    }
    return order.empty() ? 0.0 : values[order.back()];
  };
  summary.median = quantile(0.5);
  summary.q5 = quantile(0.05);
  summary.q95 = quantile(0.95);
  return summary;
}

std::vector<int> resample(std::span<double const> weights, int count, double uniform) {
  std::vector<int> chosen;
  double const total = std::accumulate(weights.begin(), weights.end(), 0.0);
  double below = weights.empty() ? 0 : weights.front();
  std::size_t item = 0;
  for (int k = 0; k < count && !weights.empty(); ++k) {
    double const place = (k + uniform) / count * total;
    while (below < place && item + 1 < weights.size()) below += weights[++item];
    chosen.push_back(static_cast<int>(item));
  }
  return chosen;
}

}  // namespace sysid
