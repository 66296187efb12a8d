// Posterior mass at prior bounds.
#include "diagnostics/bound_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"

namespace sysid {
namespace {

constexpr std::size_t least_draws = 50;  // fewer cannot tell a density

PriorInfo const* prior_of(ParameterInfo const& parameter, std::span<PriorInfo const> priors) {
  auto const found = std::ranges::find_if(priors, [&](PriorInfo const& each) { return each.name == parameter.name; });
  return found == priors.end() ? nullptr : &*found;
}

/// The central 90 % of its prior; 0 where they are not known.
double spread_of(ParameterInfo const& parameter, PriorInfo const* prior) {
  if (parameter.improper != Improper::no) return infinity;
  return prior != nullptr && prior->q5 && prior->q95 ? *prior->q95 - *prior->q5 : 0;
}

/// Posteriors between bounds that are decades apart are compared with their prior on its own scale.
bool is_logarithmic(PriorInfo const* prior) {
  return prior == nullptr || !prior->numbers || prior->numbers->distribution.starts_with("log");
}

}  // namespace

BoundCheck check_bounds(std::span<double const> draws, double lower, double upper, double prior_spread, BoundRule rule) {
  bool const one_bound = std::isfinite(lower) != std::isfinite(upper);
  bool const natural = one_bound && (lower == 0 || upper == 0) && !rule.also_natural;
  if (draws.size() < least_draws || (!std::isfinite(lower) && !std::isfinite(upper)) || natural) return {};
  std::vector<double> x(draws.begin(), draws.end());
  if (rule.logarithmic && !one_bound && lower > 0 && upper >= 10 * lower) {
    for (double& v : x) v = elementary::log(v);
    lower = elementary::log(lower);
    upper = elementary::log(upper);
  }
  if (!std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); })) return {};
  sort_numbers(x);
  double const spread = sorted_quantile(x, 0.95) - sorted_quantile(x, 0.05);
  if (!(spread > 0) || spread > 0.5 * (one_bound ? prior_spread : upper - lower)) return {};
  double const window = 0.1 * spread;
  std::ptrdiff_t peak = 0;
  for (auto from = x.begin(), to = x.begin(); from != x.end(); ++from) {
    while (to != x.end() && *to <= *from + window) ++to;
    peak = std::max(peak, to - from);
  }
  std::ptrdiff_t const low = std::upper_bound(x.begin(), x.end(), lower + window) - x.begin();
  std::ptrdiff_t const high = x.end() - std::lower_bound(x.begin(), x.end(), upper - window);
  return {2 * low >= peak, 2 * high >= peak};
}

std::string wrong_sign_at_bound(std::string const& parameter, double lower) {
  if (lower > 0)
    return fmt::format("if `{}` moves to a smaller bound again, a sign in the equation or in the data may be wrong", parameter);
  return fmt::format(
      "if a sign in the equation or in the data is wrong, correct it; to allow negative values, use `{} ~ normal(0, sd = ...)`",
      parameter);
}

Findings check_bounds(std::span<ParameterInfo const> parameters, Draws const& draws, std::span<PriorInfo const> priors,
                      bool explains_nothing) {
  Findings findings;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    ParameterInfo const& info = parameters[p];
    PriorInfo const* const prior = prior_of(info, priors);
    BoundCheck const check =
        check_bounds(draws.column(p), info.lower, info.upper, spread_of(info, prior),
                     {.logarithmic = is_logarithmic(prior), .also_natural = explains_nothing && !info.size_alone});
    if (!check.at_lower && !check.at_upper) continue;
    std::string help = "widen the prior, unless the bound is a physical limit";
    if (check.at_lower && info.lower >= 0 && !info.size_alone) help += "; " + wrong_sign_at_bound(info.name, info.lower);
    findings.push_back(
        {FindingCode::piles_up_at_bound,
         Severity::warning,
         {info.name},
         fmt::format("the posterior of {} is concentrated at the {} bound of its prior, {:.4g}{}", info.name,
                     check.at_lower ? "lower" : "upper", check.at_lower ? info.lower : info.upper, unit_after_number(info.unit)),
         help});
  }
  return findings;
}

}  // namespace sysid
