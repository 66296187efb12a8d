// Autocovariances are summed lag by lag: few are asked for of draws that were thinned.
#include "criteria/leave_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/numeric/generalised_pareto.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr std::size_t shortest_chain = 10;

/// Deviations from the mean of each chain.
class Chains {
 public:
  Chains(std::span<double const> values, std::size_t chains)
      : deviations_(values.begin(), values.end()), n_(values.size() / chains) {
    for (std::size_t first = 0; first < values.size(); first += n_) {
      means_.push_back(mean(values.subspan(first, n_)));
      for (std::size_t i = first; i < first + n_; ++i) deviations_[i] -= means_.back();
    }
  }
  std::size_t length() const { return n_; }
  std::vector<double> const& means() const { return means_; }
  /// Mean over the chains of the autocovariance at a lag, with the divisor n.
  double autocovariance(std::size_t lag) const {
    double sum = 0;
    for (std::size_t first = 0; first < deviations_.size(); first += n_)
      for (std::size_t i = first; i + lag < first + n_; ++i) sum += deviations_[i] * deviations_[i + lag];
    return sum / static_cast<double>(n_) / static_cast<double>(means_.size());
  }

 private:
  std::vector<double> deviations_, means_;
  std::size_t n_;
};

/// Autocorrelations in pairs that fall, as far as pairs are positive, and one more.
std::vector<double> autocorrelations(Chains const& chains, double within, double var_plus) {
  auto const correlation = [&](std::size_t lag) { return 1 - (within - chains.autocovariance(lag)) / var_plus; };
  std::vector<double> rho = {1, correlation(1)};
  double even = rho[0], odd = rho[1];
  std::size_t t = 0;
  while (t + 5 < chains.length() && even + odd > 0) {
    t += 2;
    even = correlation(t);
    odd = correlation(t + 1);
    rho.resize(t + 2, 0);
    if (even + odd >= 0) {
      rho[t] = even;
      rho[t + 1] = odd;
    }
  }
  if (even > 0) rho[t] = even;
  rho.resize(t + 1);
  for (std::size_t pair = 2; pair + 2 <= t; pair += 2)
    if (rho[pair] + rho[pair + 1] > rho[pair - 2] + rho[pair - 1]) rho[pair] = rho[pair + 1] = (rho[pair - 2] + rho[pair - 1]) / 2;
  return rho;
}

}  // namespace

double relative_efficiency(std::span<double const> values, int chains) {
  auto const count = static_cast<std::size_t>(chains);
  if (values.size() / count < shortest_chain) return 1;
  Chains const all(values, count);
  auto const n = static_cast<double>(all.length()), total = static_cast<double>(values.size());
  double const within = all.autocovariance(0) * n / (n - 1);
  double const var_plus = within * (n - 1) / n + (chains > 1 ? sample_variance(all.means()) : 0);
  if (!(var_plus > 0) || !std::isfinite(var_plus)) return 1;
  std::vector<double> const rho = autocorrelations(all, within, var_plus);
  double const tau = -1 + 2 * std::accumulate(rho.begin(), rho.end() - 1, 0.0) + rho.back();
  return 1 / std::max(tau, 1 / elementary::log10(total));
}

LeftOut weighted(std::span<double const> log_ratios, double relative_efficiency) {
  int const tail = pareto_tail_length(static_cast<int>(log_ratios.size()), relative_efficiency);
  SmoothedWeights smoothed = smooth_weights(log_ratios, tail);
  double const sum = log_of_sum(smoothed.log_weights);
  for (double& each : smoothed.log_weights) each -= sum;
  return {std::move(smoothed.log_weights), smoothed.k, relative_efficiency};
}

LeftOut leave_out(std::span<double const> log_likelihood, int chains) {
  double const largest = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  std::vector<double> ratios(log_likelihood.size()), likelihood(log_likelihood.size());
  for (std::size_t s = 0; s < ratios.size(); ++s) {
    ratios[s] = -log_likelihood[s];
    likelihood[s] = log_likelihood[s] - largest;
  }
  elementary::exp_lanes(likelihood.data(), likelihood.data(), static_cast<int>(likelihood.size()));
  return weighted(ratios, relative_efficiency(likelihood, chains));
}

double log_mean(std::span<double const> log_weights, std::span<double const> log_density) {
  std::vector<double> terms(log_weights.size());
  for (std::size_t s = 0; s < terms.size(); ++s) terms[s] = log_weights[s] + log_density[s];
  return log_of_sum(terms);
}

void DrawInfluence::add(LeftOut const& weights, std::span<double const> log_density, double log_mean) {
  if (!std::isfinite(log_mean)) return;  // no draw predicts the sample: more of them would not either
  std::vector<double> share(influence_.size()), weight(weights.log_weights);
  for (std::size_t s = 0; s < share.size(); ++s) share[s] = weight[s] + log_density[s] - log_mean;
  int const draws = static_cast<int>(share.size());
  elementary::exp_lanes(share.data(), share.data(), draws);
  elementary::exp_lanes(weight.data(), weight.data(), draws);
  double const independent = std::sqrt(weights.relative_efficiency);
  for (std::size_t s = 0; s < share.size(); ++s) influence_[s] += (share[s] - weight[s]) / independent;
}

double DrawInfluence::error() const { return std::sqrt(squared_deviations(influence_, 0)); }

}  // namespace sysid
