// Bridge sampling with the optimal bridge.
#include "inference/evidence/bridge.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "diagnostics/convergence.hpp"

namespace sysid::marginal {
namespace {

/// a / (s a + t b) for the logarithm of a / b, without overflow.
double part_of(double log_ratio, double s, double t) {
  if (!(log_ratio > -700)) return 0;
  return log_ratio > 0 ? 1 / (s + t * elementary::exp(-log_ratio))
                       : elementary::exp(log_ratio) / (s * elementary::exp(log_ratio) + t);
}

struct Shares {
  double posterior, mixture;  // sum to 1
};

std::vector<double> of_mixture(std::vector<double> const& log_weights, double log_evidence, Shares const& shares) {
  std::vector<double> out;
  for (double const each : log_weights) out.push_back(part_of(each - log_evidence, shares.posterior, shares.mixture));
  return out;
}

ChainValues of_posterior(ChainValues const& log_weights, double log_evidence, Shares const& shares) {
  ChainValues out;
  for (auto const& chain : log_weights) {
    out.emplace_back();
    for (double const each : chain) out.back().push_back(part_of(log_evidence - each, shares.mixture, shares.posterior));
  }
  return out;
}

/// Of part / Z over the mixture, from the draws of both kinds: those of the posterior know what few draws of a mixture do not.
double variance_of_mixture(ChainValues const& of_p, std::vector<double> const& of_q, double log_evidence, Shares const& shares) {
  double sum = 0, square = 0, weight = 0;
  double const n = static_cast<double>(of_q.size()), m = static_cast<double>(pooled(of_p).size());
  auto const add = [&](double log_weight) {
    double const ratio = elementary::exp(std::min(300.0, log_weight - log_evidence));
    double const f = part_of(log_weight - log_evidence, shares.posterior, shares.mixture), counted = 1 / (n + m * ratio);
    weight += counted, sum += counted * f, square += counted * f * f;
  };
  for (double const each : of_q) add(each);
  for (double const each : pooled(of_p)) add(each);
  return std::max(0.0, square / weight - sum * sum / (weight * weight));
}

}  // namespace

BridgeEstimate bridge(MixtureSample const& sample, PosteriorSample const& posterior) {
  std::vector<double> of_q;
  double largest = -infinity;
  for (std::size_t k = 0; k < sample.log_density.size(); ++k) {
    of_q.push_back(sample.log_density[k] - sample.log_mixture[k]);
    largest = std::max(largest, of_q.back());
  }
  ChainValues of_p;
  double unseen = 0, count = 0, middle = 0;
  std::size_t at = 0;
  for (auto const& chain : posterior.of_chain) {
    of_p.emplace_back();
    for (double const each : chain) {
      of_p.back().push_back(each - posterior.log_mixture[at++]);
      unseen += of_p.back().back() > largest ? 1 : 0;
      middle += of_p.back().back();
      ++count;
    }
  }
  if (of_q.empty() || count == 0 || !std::isfinite(largest) || !std::isfinite(middle)) return {-infinity, infinity, 0, 1};
  double log_evidence = median(pooled(of_p)), known = count;
  BridgeEstimate estimate{log_evidence, infinity, known, unseen / count};
  auto const drawn = static_cast<double>(of_q.size());
  // The effective number of draws moves with the place of the bridge, and little.
  for (int outer = 0; outer < 3; ++outer) {
    double const counted = std::min(known, drawn);
    Shares const shares{counted / (counted + drawn), drawn / (counted + drawn)};
    std::vector<double> above;
    ChainValues below;
    for (int round = 0; round < 200; ++round) {
      above = of_mixture(of_q, log_evidence, shares);
      below = of_posterior(of_p, log_evidence, shares);
      // f = part / Z above, part below: the factor by which Z is off.
      double const factor = elementary::log(mean(above)) - elementary::log(mean(pooled(below)));
      if (!std::isfinite(factor)) return {-infinity, infinity, 0, 1};
      log_evidence += factor;
      if (std::fabs(factor) < 1e-10) break;
    }
    double const mean_above = mean(above), mean_below = mean(pooled(below));
    double const ess = ess_mean(below);
    estimate.posterior_effective = known = std::isfinite(ess) ? std::clamp(ess, 1.0, count) : count;
    estimate.log_evidence = log_evidence;
    estimate.error = std::sqrt(variance_of_mixture(of_p, of_q, log_evidence, shares) / drawn / (mean_above * mean_above) +
                               sample_variance(pooled(below)) / known / (mean_below * mean_below));
  }
  return estimate;
}

}  // namespace sysid::marginal
