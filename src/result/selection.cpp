// Shares, the leading model, and particles as draws.
#include "result/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numeric/random.hpp"
#include "result/report.hpp"

namespace sysid {

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

int SelectionReport::leader() const {
  auto const best = std::max_element(result.models.begin(), result.models.end(),
                                     [](auto const& a, auto const& b) { return a.probability < b.probability; });
  return static_cast<int>(best - result.models.begin());
}

Draws resampled_draws(SelectedModel const& model, std::uint64_t seed) {
  Draws draws;
  for (ParameterInfo const& parameter : model.parameters) {
    draws.names.push_back(parameter.name);
    draws.units.push_back(parameter.unit);
  }
  draws.parameter_count = static_cast<int>(model.parameters.size());
  draws.chains.resize(1);
  Stream stream({seed, Purpose::selection, 0, 0});
  for (int const j : resample(model.weight, static_cast<int>(model.weight.size()), stream.uniform())) {
    draws.chains[0].values.emplace_back();
    for (int d = 0; d < model.declared.rows(); ++d) draws.chains[0].values.back().push_back(model.declared(d, j));
    if (!model.log_density.empty()) draws.chains[0].log_density.push_back(model.log_density[static_cast<std::size_t>(j)]);
  }
  return draws;
}

namespace {

/// Without the columns of parameters that the model does not have.
void drop_absent(SelectedModel const& model, Draws& draws, std::vector<Summary>& summary) {
  for (std::size_t c = draws.names.size(); c-- > 0;) {
    if (!model.is_absent(draws.names[c])) continue;
    auto const at = static_cast<std::ptrdiff_t>(c);
    draws.names.erase(draws.names.begin() + at);
    draws.units.erase(draws.units.begin() + at);
    if (at < draws.parameter_count) --draws.parameter_count;
    for (Chain& chain : draws.chains)
      for (std::vector<double>& values : chain.values) values.erase(values.begin() + at);
  }
  std::erase_if(summary, [&](Summary const& each) { return model.is_absent(each.name); });
}

}  // namespace

Report leading_model(Report const& report) {
  SelectionReport const& selection = *report.selection;
  auto const lead = static_cast<std::size_t>(selection.leader());
  SelectedModel const& model = selection.result.models[lead];
  Report leading;
  leading.task = report.task;
  leading.model_name = model.name;
  leading.priors = report.priors;
  leading.data = report.data;
  if (selection.has_chains(lead)) {
    leading.draws = selection.refined_draws[lead];
    leading.summary = selection.refined[lead];
  } else {
    leading.draws = resampled_draws(model, selection.resampling_seed);
    for (WeightedSummary const& s : model.summaries) leading.summary.push_back(as_summary(s, effective_particles(model.weight)));
  }
  drop_absent(model, leading.draws, leading.summary);
  return leading;
}

bool SelectionReport::has_chains(std::size_t model) const {
  return model < refined_draws.size() && refined_draws[model].total() > 1 && model < refined.size() &&
         refined[model].size() == refined_draws[model].names.size();
}

Summary as_summary(WeightedSummary const& s, double ess) {
  double const none = std::numeric_limits<double>::quiet_NaN();
  return {s.name, s.unit, s.mean, s.median, s.sd, none, s.q5, s.q95, none, none, none, s.sd / std::sqrt(ess)};
}

double effective_particles(std::vector<double> const& weights) {
  double squares = 0;
  for (double const w : weights) squares += w * w;
  return 1 / squares;
}

}  // namespace sysid
