#include "criteria/model_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {

namespace {

/// The score of mixtures, and the multiplicative update that climbs it.
class Mixture {
 public:
  explicit Mixture(PointwiseElpd const& elpd) : density_(elpd.size(), std::vector<double>(elpd.front().size())) {
    // Densities relative to the best model's of each sample: a common factor moves no weight.
    for (std::size_t i = 0; i < elpd.front().size(); ++i) {
      double best = elpd[0][i];
      for (std::size_t k = 1; k < elpd.size(); ++k) best = std::max(best, elpd[k][i]);
      for (std::size_t k = 0; k < elpd.size(); ++k) density_[k][i] = elementary::exp(elpd[k][i] - best);
    }
  }
  double score(std::vector<double> const& weights) const {
    double sum = 0;
    for (std::size_t i = 0; i < density_.front().size(); ++i) sum += elementary::log(at(i, weights));
    return sum;
  }
  /// Updates, and returns by how much per sample other weights could score more at most than those of before.
  double climb(std::vector<double>& weights) const {
    std::vector<double> gain(weights.size(), 0);
    for (std::size_t i = 0; i < density_.front().size(); ++i) {
      double const mixture = at(i, weights);
      for (std::size_t k = 0; k < gain.size(); ++k) gain[k] += density_[k][i] / mixture;
    }
    for (std::size_t k = 0; k < gain.size(); ++k) weights[k] *= gain[k] /= static_cast<double>(density_.front().size());
    return *std::max_element(gain.begin(), gain.end()) - 1;
  }

 private:
  double at(std::size_t sample, std::vector<double> const& weights) const {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * density_[k][sample];
    return sum;
  }

  std::vector<std::vector<double>> density_;  // [models][samples]
};

/// Where a sequence of three seems to go; not to the bound, which no update leaves. SQUAREM: Varadhan and Roland 2008
std::vector<double> ahead_of(std::vector<double> const& first, std::vector<double> const& second,
                             std::vector<double> const& third) {
  constexpr double least = 0.7;  // of a weight: one that is cut to little takes long to come back
  double step = 0, turn = 0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    double const r = second[k] - first[k], v = third[k] - second[k] - r;
    step += r * r;
    turn += v * v;
  }
  if (!(turn > 0)) return third;
  double const length = std::max(std::sqrt(step / turn), 1.0);
  std::vector<double> out(first.size());
  double sum = 0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    double const r = second[k] - first[k], v = third[k] - second[k] - r;
    sum += out[k] = std::max(first[k] + 2 * length * r + length * length * v, least * third[k]);
  }
  for (double& each : out) each /= sum;
  return out;
}

}  // namespace

std::vector<double> stacking_weights(PointwiseElpd const& elpd) {
  constexpr int rounds = 10'000;
  constexpr double enough = 1e-7;
  Mixture const mixture(elpd);
  std::vector<double> weights(elpd.size(), 1 / static_cast<double>(elpd.size()));
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> const first = weights;
    if (mixture.climb(weights) < enough) break;
    std::vector<double> const second = weights;
    if (mixture.climb(weights) < enough) break;
    std::vector<double> ahead = ahead_of(first, second, weights);
    if (mixture.score(ahead) > mixture.score(weights)) weights = std::move(ahead);
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
