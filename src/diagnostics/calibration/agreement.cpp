// Errors of summaries, and the test of their differences.
#include "diagnostics/calibration/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/statistics.hpp"
#include "diagnostics/calibration/calibration.hpp"
#include "diagnostics/convergence.hpp"

namespace sysid {
namespace {

template <class Change>
ChainValues changed(ChainValues chains, Change const& change) {
  for (auto& chain : chains)
    for (double& value : chain) value = change(value);
  return chains;
}

/// At least one draw, at most all; one where it is not known.
double worth(double ess, std::size_t draws) { return std::isfinite(ess) ? std::clamp(ess, 1.0, static_cast<double>(draws)) : 1.0; }

struct Estimate {
  double value, error;
};

std::vector<Estimate> estimates(ChainValues const& chains) {
  std::vector<double> const all = pooled(chains);
  double const nan = std::nan("");
  if (all.empty() || std::any_of(all.begin(), all.end(), [](double x) { return !std::isfinite(x); }))
    return std::vector<Estimate>(5, {nan, nan});
  double const center = mean(all), variance = sample_variance(all), sd = std::sqrt(variance);
  std::vector<Estimate> out = {{center, sd / std::sqrt(worth(ess_mean(chains), all.size()))}};
  ChainValues const squares = changed(chains, [&](double x) { return (x - center) * (x - center); });
  double const of_variance = std::sqrt(sample_variance(pooled(squares)) / worth(ess_mean(squares), all.size()));
  out.push_back({sd, sd > 0 ? of_variance / (2 * sd) : 0});
  std::vector<double> sorted = all;
  std::sort(sorted.begin(), sorted.end());
  for (double const p : {0.05, 0.5, 0.95}) {
    double const at = sorted_quantile(sorted, p);
    double const ess = worth(ess_mean(changed(chains, [&](double x) { return x <= at ? 1.0 : 0.0; })), all.size());
    double const spread = std::sqrt(p * (1 - p) / ess);
    double const low = sorted_quantile(sorted, std::max(0.0, p - spread)),
                 high = sorted_quantile(sorted, std::min(1.0, p + spread));
    out.push_back({at, 0.5 * (high - low)});
  }
  return out;
}

constexpr char const* names[] = {"mean", "sd", "q5", "median", "q95"};

double two_sided_p(double z) { return elementary::erfc(std::fabs(z) / std::numbers::sqrt2); }

}  // namespace

std::vector<ComparedNumber> compare_draws(std::string const& name, std::string const& unit, ChainValues const& first,
                                          ChainValues const& second) {
  std::vector<Estimate> const one = estimates(first), other = estimates(second);
  std::vector<ComparedNumber> out;
  for (std::size_t i = 0; i < one.size(); ++i)
    out.push_back({name, unit, names[i], one[i].value, other[i].value, hypotenuse(one[i].error, other[i].error)});
  return out;
}

std::vector<ComparedNumber> compare_optimum(std::string const& name, std::string const& unit, ChainValues const& draws,
                                            double optimum, double sd) {
  std::vector<double> const all = pooled(draws);
  double const spread = std::sqrt(sample_variance(all));
  return {{name, unit, "mean", optimum, mean(all), 0.2 * spread}, {name, unit, "sd", sd, spread, 0.2 * spread}};
}

Findings agreement_findings(std::vector<ComparedNumber> const& numbers, std::string const& first, std::string const& second,
                            bool with_optimum) {
  std::vector<ComparedNumber const*> wrong;
  auto const together = static_cast<double>(numbers.size());
  auto const p = [&](ComparedNumber const& each) { return std::min(1.0, together * two_sided_p(each.z())); };
  for (ComparedNumber const& each : numbers)
    if (with_optimum ? std::fabs(each.z()) > 1 : p(each) < doubtful_p) wrong.push_back(&each);
  if (wrong.empty()) return {};
  std::stable_sort(wrong.begin(), wrong.end(), [](auto const* a, auto const* b) { return std::fabs(a->z()) > std::fabs(b->z()); });
  ComparedNumber const& worst = *wrong.front();
  std::vector<std::string> concerned;
  for (ComparedNumber const* each : wrong)
    if (std::find(concerned.begin(), concerned.end(), each->quantity) == concerned.end()) concerned.push_back(each->quantity);
  std::string const unit = worst.unit.empty() || worst.unit == "-" ? "" : " " + worst.unit;
  std::string const size = !std::isfinite(worst.z()) ? "an unknown number of standard errors"
                           : with_optimum            ? "more than a fifth of the posterior sd"
                                                     : fmt::format("{:.1f} Monte Carlo standard errors", std::fabs(worst.z()));
  return {{FindingCode::backends_disagree, !with_optimum && p(worst) < wrong_p ? Severity::error : Severity::warning, concerned,
           fmt::format("{0} and {1} differ: the {2} of {3} is {4:.4g}{5} by {0} and {6:.4g}{5} by {1}; the difference is {7}{8}",
                       first, second, worst.what, worst.quantity, worst.first, unit, worst.second, size,
                       wrong.size() > 1 ? fmt::format("; {} more numbers differ as well", wrong.size() - 1) : std::string()),
           with_optimum ? "use the back end that samples" : "run longer chains of both, and look at the findings of each"}};
}

}  // namespace sysid
