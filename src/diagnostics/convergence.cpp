// Convergence diagnostics, step for step as the R package `posterior` takes them, on deterministic elementary functions.
#include "diagnostics/convergence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/numeric/fourier.hpp"
#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether diagnostics have no value: nothing there, something not finite, or all the same. `posterior` calls a range below 2.2e-16
/// constant, which would blind it to quantities that are small in SI units; here only equal draws are constant.
bool has_no_diagnostics(ChainValues const& draws) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (auto const& chain : draws) {
    for (double const v : chain) {
      if (!std::isfinite(v)) return true;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  return !(high > low);
}

/// Each chain in two halves; the middle draw of an odd length is left out.
ChainValues split(ChainValues const& draws) {
  ChainValues first, second;
  for (auto const& chain : draws) {
    if (chain.size() < 2) return draws;
    auto const half = static_cast<std::ptrdiff_t>(chain.size() / 2);
    first.emplace_back(chain.begin(), chain.begin() + half);
    second.emplace_back(chain.end() - half, chain.end());
  }
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Draws with their places among those of all chains, one behind the other.
std::vector<Ranked> in_order(ChainValues const& draws) {
  std::vector<Ranked> order;
  order.reserve(draws.size() * draws.front().size());
  for (auto const& chain : draws)
    for (double const v : chain) order.push_back({v, static_cast<std::uint32_t>(order.size())});
  sort_by_value(order);
  return order;
}

/// The distances of draws, which rise, from their median: two sequences that rise, merged.
std::vector<Ranked> distances_in_order(std::vector<Ranked> const& order, double median) {
  auto const distance = [&](Ranked each) { return Ranked{std::fabs(each.value - median), each.place}; };
  std::vector<Ranked> distances;
  distances.reserve(order.size());
  auto above = std::lower_bound(order.begin(), order.end(), median, [](Ranked a, double b) { return a.value < b; });
  auto below = std::make_reverse_iterator(above);
  while (below != order.rend() || above != order.end()) {
    bool const lower = above == order.end() || (below != order.rend() && distance(*below).value < distance(*above).value);
    distances.push_back(distance(lower ? *below++ : *above++));
  }
  return distances;
}

/// Normal scores of the ranks over all chains, ties sharing their average rank, in the shape of `draws`: their order is that of
/// the draws or of their distances.          Vehtari et al. 2021, eq. 14
ChainValues rank_normalised(std::vector<Ranked> const& order, ChainValues const& draws) {
  std::vector<double> score(order.size());
  double const count = static_cast<double>(order.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && order[last + 1].value == order[first].value) ++last;
    double const rank = 0.5 * static_cast<double>(first + last) + 1;
    double const z = normal_score((rank - 0.375) / (count + 0.25));
    for (std::size_t i = first; i <= last; ++i) score[order[i].place] = z;
    first = last + 1;
  }
  ChainValues scores;
  std::size_t next = 0;
  for (auto const& chain : draws) {
    scores.emplace_back(score.begin() + static_cast<std::ptrdiff_t>(next),
                        score.begin() + static_cast<std::ptrdiff_t>(next + chain.size()));
    next += chain.size();
  }
  return scores;
}

/// A transform long enough for the autocovariance of the halves of these chains.
Fourier fourier_for(ChainValues const& draws) {
  std::size_t const longest = draws.empty() ? 0 : draws.front().size();
  return Fourier(std::bit_ceil(std::max<std::size_t>(4, 2 * ((longest + 1) / 2))));
}

/// Autocovariance (divisor N) at every lag, averaged over the chains. Two chains share one transform: the real part of the
/// transform of |F(a + ib)|^2 is the sum of the autocovariances of a and b. The spectrum stays in bit-reversed order, which nothing
/// minds.
std::vector<double> mean_autocovariance(ChainValues const& chains, std::vector<double> const& means, Fourier const& fourier) {
  std::size_t const n = chains.front().size();
  std::size_t const size = fourier.size();
  std::vector<double> power(size), re(size), im(size);
  auto const take = [&](std::size_t chain, std::vector<double>& part) {
    std::size_t const length = chain < chains.size() ? n : 0;
    for (std::size_t i = 0; i < length; ++i) part[i] = chains[chain][i] - means[chain];
    std::fill(part.begin() + static_cast<std::ptrdiff_t>(length), part.end(), 0.0);
  };
  for (std::size_t c = 0; c < chains.size(); c += 2) {
    take(c, re);
    take(c + 1, im);
    fourier.to_reversed(re, im);
    for (std::size_t k = 0; k < size; ++k) power[k] += re[k] * re[k] + im[k] * im[k];
  }
  std::fill(im.begin(), im.end(), 0.0);
  fourier.from_reversed(power, im);  // its own inverse but for the scale, as only the real part is read
  std::vector<double> covariance(n);
  double const scale = static_cast<double>(size) * static_cast<double>(n) * static_cast<double>(chains.size());
  for (std::size_t k = 0; k < n; ++k) covariance[k] = power[k] / scale;
  return covariance;
}

/// Potential scale reduction of chains that are already split.          Gelman et al. 2013, eq. 11.4
double basic_rhat(ChainValues const& chains) {
  if (chains.empty() || has_no_diagnostics(chains)) return nan;
  double const n = static_cast<double>(chains.front().size());
  std::vector<double> means, variances;
  for (auto const& chain : chains) {
    means.push_back(corrected_mean(chain));
    variances.push_back(corrected_variance(chain));
  }
  return std::sqrt((n * corrected_variance(means) / corrected_mean(variances) + n - 1) / n);
}

/// Effective sample size of chains that are already split: Geyer's initial monotone sequence.          Vehtari et al. 2021,
/// sec. 3.2
double basic_ess(ChainValues const& chains, Fourier const& fourier) {
  if (chains.empty() || chains.front().size() < 3 || has_no_diagnostics(chains)) return nan;
  std::size_t const length = chains.front().size();
  double const n = static_cast<double>(length);
  std::vector<double> means;
  for (auto const& chain : chains) means.push_back(corrected_mean(chain));
  std::vector<double> const covariance = mean_autocovariance(chains, means, fourier);
  double const within = covariance[0] * n / (n - 1);
  double const total = within * (n - 1) / n + (chains.size() > 1 ? corrected_variance(means) : 0.0);
  auto const correlation = [&](std::size_t lag) { return 1 - (within - covariance[lag]) / total; };

  std::vector<double> rho(length, 0.0);
  double even = 1, odd = correlation(1);
  rho[0] = even;
  rho[1] = odd;
  std::size_t t = 0;
  while (t + 5 < length && even + odd > 0) {  // also ends at NaN
    t += 2;
    even = correlation(t);
    odd = correlation(t + 1);
    if (even + odd >= 0) {
      rho[t] = even;
      rho[t + 1] = odd;
    }
  }
  std::size_t const last = t;
  if (even > 0) rho[last] = even;
  for (t = 2; t + 2 <= last; t += 2) {
    if (rho[t] + rho[t + 1] > rho[t - 2] + rho[t - 1]) rho[t] = rho[t + 1] = (rho[t - 2] + rho[t - 1]) / 2;
  }
  // The sum over lags 0 .. last - 1; with last = 0 `posterior` still counts lag 0 (R's 1:0), and so do we.
  double sum = last == 0 ? rho[0] : 0;
  for (std::size_t i = 0; i < last; ++i) sum += rho[i];
  double const count = static_cast<double>(chains.size()) * n;
  // Antithetic chains can look better than independent ones; the bound keeps the estimate stable.
  double const tau = std::max(-1 + 2 * sum + rho[last], 1 / elementary::log10(count));
  return count / tau;
}

/// Of the share of draws up to `bound`; halves: split chains.
double ess_of_quantile(ChainValues const& halves, double bound, Fourier const& fourier) {
  ChainValues below = halves;
  for (auto& chain : below)
    for (double& v : chain) v = v <= bound ? 1.0 : 0.0;
  return basic_ess(below, fourier);
}

std::vector<double> sorted(ChainValues const& draws) {
  std::vector<double> all = pooled(draws);
  std::sort(all.begin(), all.end());
  return all;
}

/// halves: split chains; scores: theirs; distances: from the median of the draws.
double rhat_of(ChainValues const& halves, ChainValues const& scores, std::vector<Ranked> const& distances) {
  double const bulk = basic_rhat(scores);
  double const tail = basic_rhat(rank_normalised(distances, halves));
  return std::isnan(bulk) || std::isnan(tail) ? nan : std::max(bulk, tail);
}

double smaller_or_nan(double a, double b) { return std::isnan(a) || std::isnan(b) ? nan : std::min(a, b); }

}  // namespace

double rhat(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  ChainValues const halves = split(draws);
  std::vector<Ranked> const order = in_order(halves);
  return rhat_of(halves, rank_normalised(order, halves), distances_in_order(order, sorted_quantile(sorted(draws), 0.5)));
}

double ess_bulk(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  ChainValues const halves = split(draws);
  return basic_ess(rank_normalised(in_order(halves), halves), fourier_for(draws));
}

double ess_tail(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  std::vector<double> const all = sorted(draws);
  ChainValues const halves = split(draws);
  Fourier const fourier = fourier_for(draws);
  return smaller_or_nan(ess_of_quantile(halves, sorted_quantile(all, 0.05), fourier),
                        ess_of_quantile(halves, sorted_quantile(all, 0.95), fourier));
}

double ess_mean(ChainValues const& draws) { return basic_ess(split(draws), fourier_for(draws)); }

double mcse_mean(ChainValues const& draws) { return std::sqrt(corrected_variance(pooled(draws)) / ess_mean(draws)); }

Summary summarise(std::string name, std::string unit, ChainValues const& draws) {
  Summary summary;
  summary.name = std::move(name);
  summary.unit = std::move(unit);
  std::vector<double> all = pooled(draws);
  if (all.empty() || std::any_of(all.begin(), all.end(), [](double v) { return !std::isfinite(v); })) return summary;
  summary.mean = corrected_mean(all);
  summary.sd = std::sqrt(corrected_variance(all));
  // Sorting is done once; halves of an odd length lack the middle draw.
  ChainValues const halves = split(draws);
  std::vector<Ranked> const order = in_order(halves);
  bool const whole = order.size() == all.size();
  auto const take = [&](std::vector<Ranked> const& from) {
    std::transform(from.begin(), from.end(), all.begin(), [](Ranked each) { return each.value; });
  };
  if (whole)
    take(order);
  else
    std::sort(all.begin(), all.end());
  summary.median = sorted_quantile(all, 0.5);
  summary.q5 = sorted_quantile(all, 0.05);
  summary.q95 = sorted_quantile(all, 0.95);
  std::vector<Ranked> const distances = distances_in_order(order, summary.median);
  if (whole) {
    take(distances);
  } else {
    for (double& v : all) v = std::fabs(v - summary.median);
    std::sort(all.begin(), all.end());
  }
  summary.mad = sd_of_mad * sorted_quantile(all, 0.5);
  if (has_no_diagnostics(draws)) return summary;
  ChainValues const scores = rank_normalised(order, halves);
  summary.rhat = rhat_of(halves, scores, distances);
  Fourier const fourier = fourier_for(draws);
  summary.ess_bulk = basic_ess(scores, fourier);
  summary.ess_tail = smaller_or_nan(ess_of_quantile(halves, summary.q5, fourier), ess_of_quantile(halves, summary.q95, fourier));
  summary.mcse_mean = summary.sd / std::sqrt(basic_ess(halves, fourier));
  return summary;
}

}  // namespace sysid
