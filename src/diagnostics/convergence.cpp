// Convergence diagnostics, step for step as the R package `posterior` takes them, on deterministic elementary functions.
#include "diagnostics/convergence.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/numeric/lagged_products.hpp"
#include "core/numeric/normal_quantile.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether diagnostics have no value: nothing there, something not finite, or all the same. `posterior` calls a range below 2.2e-16
/// constant, which would blind it to quantities that are small in SI units; here only equal draws are constant.
bool has_no_diagnostics(ChainValues const& draws) {
  double const* first = nullptr;
  int differ = 0, infinite = 0;
  for (auto const& chain : draws) {
    if (first == nullptr && !chain.empty()) first = chain.data();
    for (double const v : chain) {
      differ |= v != *first ? 1 : 0;
      infinite |= v - v == 0 ? 0 : 1;
    }
  }
  return differ == 0 || infinite != 0;
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
ChainValues rank_normalised(std::vector<Ranked> const& order, ChainValues const& draws, ConvergenceTables& tables) {
  std::vector<double> score(order.size());
  std::vector<double>& known = tables.scores(order.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && order[last + 1].value == order[first].value) ++last;
    std::size_t const twice_rank = first + last + 2;
    double& z = known[twice_rank / 2 + (twice_rank % 2 == 0 ? 0 : order.size() + 1)];
    if (std::isnan(z))
      z = normal_score((0.5 * static_cast<double>(twice_rank) - 0.375) / (static_cast<double>(order.size()) + 0.25));
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

/// Chains whose sums are taken at once, which hides their latency. Each is that of `corrected_mean`, in its order.
constexpr std::size_t side_by_side = 8;

template <class Visit>
void for_groups(ChainValues const& chains, Visit const& visit) {
  for (std::size_t first = 0; first < chains.size(); first += side_by_side) {
    double const* group[side_by_side];
    for (std::size_t k = 0; k < side_by_side; ++k) group[k] = chains[std::min(first + k, chains.size() - 1)].data();
    visit(group, first, std::min(side_by_side, chains.size() - first));
  }
}

/// Of chains of one length, which are not empty.
std::vector<double> corrected_means(ChainValues const& chains) {
  std::vector<double> means(chains.size());
  std::size_t const n = chains.front().size();
  for_groups(chains, [&](double const* const* group, std::size_t first, std::size_t count) {
    double sum[side_by_side] = {}, rest[side_by_side] = {};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < side_by_side; ++k) sum[k] += group[k][i];
    for (double& each : sum) each /= static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < side_by_side; ++k) rest[k] += group[k][i] - sum[k];
    for (std::size_t k = 0; k < count; ++k) means[first + k] = sum[k] + rest[k] / static_cast<double>(n);
  });
  return means;
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

/// The same lag by lag, as it is asked for. Of draws that soon forget where they were, few lags are, which cost less than the
/// transform that has all of them.
class Autocovariance {
 public:
  Autocovariance(ChainValues const& chains, std::vector<double> const& means, ConvergenceTables& tables)
      : chains_(chains), means_(means), tables_(tables), size_(chains.front().size()) {
    centred_.reserve(chains.size() * size_);
    for (std::size_t c = 0; c < chains.size(); ++c)
      for (double const v : chains[c]) centred_.push_back(v - means[c]);
  }

  /// lag < the length of the chains.
  double operator()(std::size_t lag) {
    while (lag >= known_.size()) learn();
    return known_[lag];
  }

 private:
  /// Lags up to which sums are taken one by one, and where it is seen whether the correlation will have gone by then.
  static constexpr std::size_t most_lags = 128, look = 16;

  void learn() {
    std::size_t const from = known_.size();
    bool const slow = from == look && known_.back() > known_.front() / 2;
    if (slow || from >= most_lags) {
      std::vector<double> const all = mean_autocovariance(chains_, means_, tables_.fourier(2 * size_));
      known_.insert(known_.end(), all.begin() + static_cast<std::ptrdiff_t>(from), all.end());
      return;
    }
    double sums[lags_at_once] = {};
    for (std::size_t c = 0; c < chains_.size(); ++c)
      add_lagged_products(centred_.data() + c * size_, static_cast<long>(size_), static_cast<long>(from), sums);
    for (double const sum : sums) known_.push_back(sum / (static_cast<double>(size_) * static_cast<double>(chains_.size())));
  }

  ChainValues const& chains_;
  std::vector<double> const& means_;
  ConvergenceTables& tables_;
  std::size_t size_;
  std::vector<double> centred_;  // chain after chain
  std::vector<double> known_;    // of the first lags
};

/// Potential scale reduction of chains that are already split.          Gelman et al. 2013, eq. 11.4
double basic_rhat(ChainValues const& chains, std::vector<double> const& means) {
  double const n = static_cast<double>(chains.front().size());
  std::vector<double> variances;
  for (std::size_t c = 0; c < chains.size(); ++c) variances.push_back(corrected_variance(chains[c], means[c]));
  return std::sqrt((n * corrected_variance(means) / corrected_mean(variances) + n - 1) / n);
}

/// Effective sample size of chains that are already split: Geyer's initial monotone sequence.          Vehtari et al. 2021,
/// sec. 3.2
double basic_ess(ChainValues const& chains, std::vector<double> const& means, ConvergenceTables& tables) {
  std::size_t const length = chains.front().size();
  if (length < 3) return nan;
  double const n = static_cast<double>(length);
  Autocovariance covariance(chains, means, tables);
  double const within = covariance(0) * n / (n - 1);
  double const total = within * (n - 1) / n + (chains.size() > 1 ? corrected_variance(means) : 0.0);
  auto const correlation = [&](std::size_t lag) { return 1 - (within - covariance(lag)) / total; };

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

double basic_ess(ChainValues const& chains, ConvergenceTables& tables) {
  if (chains.empty() || chains.front().empty() || has_no_diagnostics(chains)) return nan;
  return basic_ess(chains, corrected_means(chains), tables);
}

/// Of the share of draws up to `bound`; halves: split chains.
double ess_of_quantile(ChainValues const& halves, double bound, ConvergenceTables& tables) {
  ChainValues below = halves;
  for (auto& chain : below)
    for (double& v : chain) v = v <= bound ? 1.0 : 0.0;
  return basic_ess(below, tables);
}

std::vector<double> sorted(ChainValues const& draws) {
  std::vector<double> all = pooled(draws);
  sort_numbers(all);
  return all;
}

/// Of ranks: R-hat and the effective number of draws.
struct Ranks {
  double rhat = nan, ess = nan;
};

Ranks ranks_of(ChainValues const& scores, bool with_ess, ConvergenceTables& tables) {
  if (scores.empty() || scores.front().empty() || has_no_diagnostics(scores)) return {};
  std::vector<double> const means = corrected_means(scores);
  return {basic_rhat(scores, means), with_ess ? basic_ess(scores, means, tables) : nan};
}

double larger_or_nan(double a, double b) { return std::isnan(a) || std::isnan(b) ? nan : std::max(a, b); }
double smaller_or_nan(double a, double b) { return std::isnan(a) || std::isnan(b) ? nan : std::min(a, b); }

}  // namespace

std::vector<double>& ConvergenceTables::scores(std::size_t count) {
  if (scores_.size() != 2 * (count + 1)) scores_.assign(2 * (count + 1), nan);
  return scores_;
}

Fourier const& ConvergenceTables::fourier(std::size_t draws) {
  std::size_t const size = std::bit_ceil(std::max<std::size_t>(4, 2 * ((draws + 1) / 2)));
  if (!fourier_ || fourier_->size() != size) fourier_.emplace(size);
  return *fourier_;
}

ChainValues chains_of(Draws const& draws, std::size_t column) {
  ChainValues values;
  for (Chain const& chain : draws.chains) {
    values.emplace_back();
    for (auto const& draw : chain.values) values.back().push_back(draw[column]);
  }
  return values;
}

double rhat(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  ChainValues const halves = split(draws);
  std::vector<Ranked> const order = in_order(halves);
  ConvergenceTables tables;
  auto const rhat_of = [&](std::vector<Ranked> const& ranked) {
    return ranks_of(rank_normalised(ranked, halves, tables), false, tables).rhat;
  };
  return larger_or_nan(rhat_of(order), rhat_of(distances_in_order(order, sorted_quantile(sorted(draws), 0.5))));
}

double ess_bulk(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  ChainValues const halves = split(draws);
  ConvergenceTables tables;
  return basic_ess(rank_normalised(in_order(halves), halves, tables), tables);
}

double ess_tail(ChainValues const& draws) {
  if (has_no_diagnostics(draws)) return nan;
  std::vector<double> const all = sorted(draws);
  ChainValues const halves = split(draws);
  ConvergenceTables tables;
  return smaller_or_nan(ess_of_quantile(halves, sorted_quantile(all, 0.05), tables),
                        ess_of_quantile(halves, sorted_quantile(all, 0.95), tables));
}

double ess_mean(ChainValues const& draws) {
  ConvergenceTables tables;
  return basic_ess(split(draws), tables);
}

double mcse_mean(ChainValues const& draws) { return std::sqrt(corrected_variance(pooled(draws)) / ess_mean(draws)); }

Summary summarise(std::string name, std::string unit, ChainValues const& draws) {
  ConvergenceTables tables;
  return summarise(std::move(name), std::move(unit), draws, tables);
}

Summary summarise(std::string name, std::string unit, ChainValues const& draws, ConvergenceTables& tables) {
  Summary summary;
  summary.name = std::move(name);
  summary.unit = std::move(unit);
  std::vector<double> all = pooled(draws);
  if (all.empty() || std::any_of(all.begin(), all.end(), [](double v) { return !std::isfinite(v); })) return summary;
  summary.mean = corrected_mean(all);
  summary.sd = std::sqrt(corrected_variance(all, summary.mean));
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
    sort_numbers(all);
  summary.median = sorted_quantile(all, 0.5);
  summary.q5 = sorted_quantile(all, 0.05);
  summary.q95 = sorted_quantile(all, 0.95);
  std::vector<Ranked> const distances = distances_in_order(order, summary.median);
  if (whole) {
    take(distances);
  } else {
    for (double& v : all) v = std::fabs(v - summary.median);
    sort_numbers(all);
  }
  summary.mad = sd_of_mad * sorted_quantile(all, 0.5);
  if (has_no_diagnostics(draws)) return summary;
  Ranks const bulk = ranks_of(rank_normalised(order, halves, tables), true, tables);
  Ranks const tail = ranks_of(rank_normalised(distances, halves, tables), false, tables);
  summary.rhat = larger_or_nan(bulk.rhat, tail.rhat);
  summary.ess_bulk = bulk.ess;
  summary.ess_tail = smaller_or_nan(ess_of_quantile(halves, summary.q5, tables), ess_of_quantile(halves, summary.q95, tables));
  summary.mcse_mean = summary.sd / std::sqrt(basic_ess(halves, tables));
  return summary;
}

}  // namespace sysid
