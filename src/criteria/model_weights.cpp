#include "criteria/model_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {

std::vector<double> stacking_weights(PointwiseElpd const& elpd) {
  std::size_t const models = elpd.size(), samples = elpd.front().size();
  // Densities relative to the best model's of each sample: a common factor moves no weight.
  std::vector<std::vector<double>> density(models, std::vector<double>(samples));
  for (std::size_t i = 0; i < samples; ++i) {
    double best = elpd[0][i];
    for (std::size_t k = 1; k < models; ++k) best = std::max(best, elpd[k][i]);
    for (std::size_t k = 0; k < models; ++k) density[k][i] = elementary::exp(elpd[k][i] - best);
  }
  std::vector<double> weights(models, 1 / static_cast<double>(models)), gain(models);
  constexpr int rounds = 20'000;
  constexpr double enough = 1e-7;
  for (int round = 0; round < rounds; ++round) {
    std::fill(gain.begin(), gain.end(), 0);
    for (std::size_t i = 0; i < samples; ++i) {
      double mixture = 0;
      for (std::size_t k = 0; k < models; ++k) mixture += weights[k] * density[k][i];
      for (std::size_t k = 0; k < models; ++k) gain[k] += density[k][i] / mixture;
    }
    for (std::size_t k = 0; k < models; ++k) weights[k] *= gain[k] /= static_cast<double>(samples);
    if (*std::max_element(gain.begin(), gain.end()) < 1 + enough) break;
  }
  return weights;
}

std::vector<double> pseudo_bma_weights(PointwiseElpd const& elpd, std::uint64_t seed) {
  constexpr std::uint64_t bootstraps = 1000;
  std::size_t const models = elpd.size(), samples = elpd.front().size();
  std::vector<double> weights(models, 0), sum(models), share(samples);
  for (std::uint64_t b = 0; b < bootstraps; ++b) {
    Stream stream({seed, Purpose::bootstrap, b, 0});
    double total = 0;  // exponential variates over their sum: uniform on the simplex
    for (double& each : share) total += each = -elementary::log(stream.uniform());
    for (std::size_t k = 0; k < models; ++k) {
      sum[k] = 0;
      for (std::size_t i = 0; i < samples; ++i) sum[k] += share[i] * elpd[k][i];
      sum[k] *= static_cast<double>(samples) / total;
    }
    double const best = *std::max_element(sum.begin(), sum.end());
    double all = 0;
    for (double& each : sum) all += each = elementary::exp(each - best);
    for (std::size_t k = 0; k < models; ++k) weights[k] += sum[k] / all / static_cast<double>(bootstraps);
  }
  return weights;
}

ElpdDifference elpd_difference(std::span<double const> a, std::span<double const> b) {
  std::vector<double> difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] == b[i] ? 0 : a[i] - b[i];  // also of two infinite ones
  bool const finite = std::ranges::all_of(difference, [](double each) { return std::isfinite(each); });
  if (!finite) return {std::accumulate(difference.begin(), difference.end(), 0.0), std::nan("")};
  auto const n = static_cast<double>(a.size());
  return {n * mean(difference), std::sqrt(n * sample_variance(difference))};
}

}  // namespace sysid
