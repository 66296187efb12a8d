// One function per statistic, which rejects arguments that it cannot handle.
#include "repl/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/statistics.hpp"

namespace sysid::repl {
namespace {

using Values = std::vector<double>;
using Value = std::optional<double>;

double sum_of_products(Values const& a, Values const& b) {
  double const mean_a = sysid::mean(a), mean_b = sysid::mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum;
}

/// False, and said so, where an argument is one number.
bool scatters(Asked const& asked, std::size_t argument = 0) {
  Quantity const& quantity = argument == 0 ? asked.of : *asked.other;
  if (quantity.values.size() > 1) return true;
  auto const [message, help] = without_draws(quantity);
  asked.refuse(asked.call.arguments[argument].span, message, help);
  return false;
}

Value mean(Asked const& asked) { return sysid::mean(asked.values); }

Value sd(Asked const& asked) {
  if (asked.of.sd) return asked.of.sd;
  if (!scatters(asked)) return {};
  auto const others = static_cast<double>(std::max<std::size_t>(asked.values.size() - 1, 1));
  return std::sqrt(sum_of_products(asked.values, asked.values) / others);
}

Value median(Asked const& asked) { return sysid::median(asked.values); }

Value quantile(Asked const& asked) {
  if (!scatters(asked)) return {};
  Values const& part = asked.other->values;
  if (part.size() == 1 && part[0] >= 0 && part[0] <= 1) return sysid::quantile(asked.values, part[0]);
  asked.refuse(asked.call.arguments[1].span, "the level of a quantile must lie between 0 and 1", "for example `quantile(k, 0.95)`");
  return {};
}

Value min(Asked const& asked) { return *std::min_element(asked.values.begin(), asked.values.end()); }
Value max(Asked const& asked) { return *std::max_element(asked.values.begin(), asked.values.end()); }

Value rms(Asked const& asked) {
  double const squares = std::inner_product(asked.values.begin(), asked.values.end(), asked.values.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(asked.values.size()));
}

Value corr(Asked const& asked) {
  if (!scatters(asked) || !scatters(asked, 1)) return {};
  if (auto const why = unpaired(asked.of, *asked.other)) {
    asked.refuse(asked.call.span, *why, "a correlation needs draws of one fit, or samples of one record");
    return {};
  }
  Values a, b;
  for (std::size_t i = 0; i < asked.of.values.size(); ++i)
    if (std::isfinite(asked.of.values[i]) && std::isfinite(asked.other->values[i])) {
      a.push_back(asked.of.values[i]);
      b.push_back(asked.other->values[i]);
    }
  return sum_of_products(a, b) / std::sqrt(sum_of_products(a, a) * sum_of_products(b, b));
}

Value probability(Asked const& asked) {
  if (!scatters(asked)) return {};
  if (std::all_of(asked.values.begin(), asked.values.end(), [](double each) { return each == 0 || each == 1; }))
    return sysid::mean(asked.values);
  asked.refuse(asked.call.arguments[0].span, "`probability` takes a comparison", "for example `probability(k3 > 0)`");
  return {};
}

Value count(Asked const& asked) { return static_cast<double>(asked.values.size()); }

constexpr StatisticRow statistic_rows[] = {
    {{"mean", "mean(k)", "mean over draws, or over the samples of a record"}, 1, false, &mean},
    {{"sd", "sd(k)", "standard deviation; for an optimum, the one of Laplace's approximation"}, 1, false, &sd},
    {{"median", "median(k)", "median of the draws"}, 1, false, &median},
    {{"quantile", "quantile(k, 0.95)", "quantile of the draws: the value below which the given fraction lies"},
     2,
     false,
     &quantile},
    {{"min", "min(k)", "the smallest draw or sample"}, 1, false, &min},
    {{"max", "max(k)", "the largest draw or sample"}, 1, false, &max},
    {{"rms", "rms(residual(output))", "root mean square"}, 1, false, &rms},
    {{"corr", "corr(k, k3)", "correlation of two quantities, over draws or samples"}, 2, true, &corr},
    {{"probability", "probability(k3 > 0)", "fraction of the draws for which a comparison holds"}, 1, true, &probability},
    {{"count", "count(k)", "number of draws or samples"}, 1, true, &count},
};

constexpr PromptFunction series_rows[] = {
    {"measured", "measured(output)", "measured samples of a channel on the rows that were fitted or predicted"},
    {"predicted", "predicted(output)", "mean prediction of a channel, without noise, on the rows that were fitted or predicted"},
    {"residual", "residual(output)", "measured minus predicted"},
};

}  // namespace

std::span<StatisticRow const> statistics() { return statistic_rows; }
std::span<PromptFunction const> series_functions() { return series_rows; }

std::vector<PromptFunction> prompt_functions() {
  std::vector<PromptFunction> all(std::begin(statistic_rows), std::end(statistic_rows));
  all.insert(all.end(), std::begin(series_rows), std::end(series_rows));
  return all;
}

}  // namespace sysid::repl
