// Ratios of densities as one kernel for each parameter, run over all draws.
#include "inference/evidence/prior_widths.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/generalised_pareto.hpp"
#include "core/numeric/not_finite.hpp"
#include "diagnostics/convergence.hpp"
#include "distribution/distribution.hpp"
#include "program/kernel.hpp"

namespace sysid {
namespace {

constexpr std::array<double, 4> factors = {0.25, 0.5, 2, 4};
constexpr double least_ratios = 50;      // independent ones: an error of a seventh where they vary by themselves
constexpr double heaviest_tail = 0.5;    // of the ratios, Pareto's k: above, their variance is infinite
constexpr double edge = 0.01;            // of the prior, at a bound that the wider one moves
constexpr double negligible_mass = 0.1;  // of the posterior, beyond such a bound

/// A prior with numbers in the graph that its kernel is compiled from.
struct Numbered {
  Distribution use;
  double low = -infinity, high = infinity;  // its support

  Numbered(Graph& graph, DistributionRow const& row, std::vector<double> const& arguments, PriorNumbers const& numbers)
      : use{&row, {}, {}, {}} {
    for (double const argument : arguments) use.arguments.push_back(graph.constant(argument));
    if (numbers.lower) use.lower = graph.constant(*numbers.lower);
    if (numbers.upper) use.upper = graph.constant(*numbers.upper);
    Support const bounds = support(graph, use);
    if (bounds.lower) low = graph.constant_value(*bounds.lower).value();
    if (bounds.upper) high = graph.constant_value(*bounds.upper).value();
  }
  /// The share of it that lies below a number.
  double below(Graph& graph, double x) const {
    return std::isfinite(x) ? graph.constant_value(use.row->cumulative(graph, graph.constant(x), use.arguments)).value()
                            : (x > 0 ? 1.0 : 0.0);
  }
};

/// log p_f - log p of one parameter at the draws.
struct Ratios {
  std::array<std::vector<double>, factors.size()> log;  // [draws]; empty where no prior is so wide
  std::array<double, factors.size()> beyond = {};       // share of the posterior that the wider prior would move out of reach
};

/// Nothing for a prior without a width.
std::optional<Ratios> ratios_of(PriorInfo const& prior, std::vector<double> const& declared) {
  if (!prior.numbers) return std::nullopt;
  PriorNumbers const& numbers = *prior.numbers;
  DistributionRow const* row = find_distribution(numbers.distribution);
  if (row == nullptr || row->widen == nullptr || !row->proper) return std::nullopt;
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::unknown, 0);
  Numbered const stated(graph, *row, numbers.arguments, numbers);
  NodeId const density = log_density(graph, stated.use, x);
  std::vector<NodeId> outputs;
  std::array<std::optional<Numbered>, factors.size()> widened;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    std::vector<double> arguments = numbers.arguments;
    row->widen(factors[f], arguments);
    if (row->refuse(arguments).empty()) widened[f].emplace(graph, *row, arguments, numbers);
    outputs.push_back(widened[f] ? graph.subtract(log_density(graph, widened[f]->use, x), density) : density);
  }
  outputs.push_back(row->cumulative(graph, x, stated.use.arguments));
  LaneArray values(1, static_cast<int>(declared.size())), out(static_cast<int>(outputs.size()), values.width());
  for (int w = 0; w < values.width(); ++w) values(0, w) = declared[static_cast<std::size_t>(w)] * numbers.scale;
  run(compile_kernel(graph, std::span(&x, 1), outputs), values, out);

  double const from = stated.below(graph, stated.low), to = stated.below(graph, stated.high), step = edge * (to - from);
  double at_low = 0, at_high = 0;
  for (double const share : out.row(static_cast<int>(factors.size()))) {
    at_low += share < from + step ? 1.0 / values.width() : 0;
    at_high += share > to - step ? 1.0 / values.width() : 0;
  }
  Ratios result;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    if (!widened[f]) continue;
    Numbered const& other = *widened[f];
    std::span<double const> const row_of = out.row(static_cast<int>(f));
    result.log[f].assign(row_of.begin(), row_of.end());
    for (std::size_t d = 0; d < declared.size(); ++d)
      if (double const si = values(0, static_cast<int>(d)); si <= other.low || si >= other.high) result.log[f][d] = -infinity;
    // As if the posterior went on beyond the bound as it ends there.
    double const inside = other.below(graph, stated.high) - other.below(graph, stated.low);
    if (other.low < stated.low)
      result.beyond[f] += at_low / edge * (other.below(graph, stated.low) - other.below(graph, other.low)) / inside;
    if (other.high > stated.high)
      result.beyond[f] += at_high / edge * (other.below(graph, other.high) - other.below(graph, stated.high)) / inside;
  }
  return result;
}

/// Whether a mean of the ratios has an error that can be stated: by the fit to their largest, or because these are all alike, as
/// those of a prior between bounds.
bool has_variance(std::vector<double> const& log_ratio, double relative_efficiency) {
  int const tail = pareto_tail_length(static_cast<int>(log_ratio.size()), relative_efficiency);
  double const k = smooth_weights(log_ratio, tail).k, largest = *std::max_element(log_ratio.begin(), log_ratio.end());
  if (k < infinity) return k <= heaviest_tail;
  auto const alike = std::count_if(log_ratio.begin(), log_ratio.end(), [&](double each) { return each > largest - 1e-9; });
  return alike >= tail;
}

PriorWidth effect(std::string parameter, double factor, std::vector<double> const& log_ratio, double beyond, Draws const& draws) {
  PriorWidth result{std::move(parameter), factor, {}, 0};
  if (log_ratio.empty() || beyond > negligible_mass) return result;
  double const largest = *std::max_element(log_ratio.begin(), log_ratio.end());
  if (!std::isfinite(largest)) return result;
  ChainValues ratios;
  double sum = 0, square = 0, deviation = 0;
  std::size_t at = 0;
  for (Chain const& chain : draws.chains) {
    ratios.emplace_back();
    for (std::size_t d = 0; d < chain.values.size(); ++d) {
      double const ratio = elementary::exp(log_ratio[at++] - largest);
      ratios.back().push_back(ratio);
      sum += ratio;
      square += ratio * ratio;
    }
  }
  auto const count = static_cast<double>(at);
  double const mean = sum / count;
  for (std::vector<double> const& chain : ratios)
    for (double const each : chain) deviation += (each - mean) * (each - mean);
  if (deviation > 1e-20 * mean * mean * count) {  // more than rounding
    double const independent = ess_mean(ratios);  // NaN where a chain is too short
    if (!(independent * (sum * sum / square) / count >= least_ratios) ||
        !has_variance(log_ratio, std::min(1.0, independent / count)))
      return result;
    result.error = std::sqrt(deviation / count / independent) / mean;
  }
  result.change = largest + elementary::log(mean);
  return result;
}

}  // namespace

std::vector<PriorWidth> prior_widths(std::vector<PriorInfo> const& priors, Draws const& draws) {
  std::vector<PriorWidth> effects;
  if (draws.total() < 2) return effects;
  std::array<std::vector<double>, factors.size()> joint;
  std::array<double, factors.size()> beyond = {};
  for (std::vector<double>& each : joint) each.assign(draws.total(), 0);
  for (PriorInfo const& prior : priors) {
    auto const name = std::find(draws.names.begin(), draws.names.end(), prior.name);
    if (name == draws.names.end()) continue;
    auto const ratios = ratios_of(prior, draws.column(static_cast<std::size_t>(name - draws.names.begin())));
    if (!ratios) continue;
    for (std::size_t f = 0; f < factors.size(); ++f) {
      effects.push_back(effect(prior.name, factors[f], ratios->log[f], ratios->beyond[f], draws));
      if (ratios->log[f].empty()) joint[f].clear();
      for (std::size_t d = 0; d < joint[f].size(); ++d) joint[f][d] += ratios->log[f][d];
      beyond[f] += ratios->beyond[f];
    }
  }
  if (effects.size() <= factors.size()) return effects;
  for (std::size_t f = 0; f < factors.size(); ++f) effects.push_back(effect("", factors[f], joint[f], beyond[f], draws));
  return effects;
}

}  // namespace sysid
