// Reweighting, resampling and moves of a population between prior and posterior.
#include "inference/evidence/smc.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/evidence/mixture.hpp"

namespace sysid::marginal {
namespace {

constexpr std::uint64_t smc_step = 2'000'000;  // of Purpose::evidence; moves count on from it
constexpr std::uint64_t resampling_step = 1'500'000;
constexpr int least_moves = 4, most_moves = 24;  // per power
constexpr double worth = 0.5;                    // of the particles, after a weighting

struct Particles {
  LaneArray theta;
  std::vector<double> log_prior, log_likelihood;
  std::vector<std::size_t> ancestor;  // among the first ones

  std::size_t size() const { return log_prior.size(); }
};

class Tempering {
 public:
  Tempering(Target const& target, int particles, std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop)
      : target_(target), seed_(seed), ledger_(ledger), stop_(stop), all_{LaneArray(target.dimension(), particles), {}, {}, {}} {
    target.sample_prior({seed, Purpose::evidence, 0, smc_step - 1}, all_.theta);
    evaluate(all_.theta, all_.log_prior, all_.log_likelihood);
    for (std::size_t w = 0; w < all_.size(); ++w) all_.ancestor.push_back(w);
  }

  SmcEstimate run(std::uint64_t most) {
    double power = 0;
    SmcEstimate estimate;
    while (power < 1 && !(stop_ && stop_()) && simulations_ + least_moves * all_.size() <= most) {
      double const next = next_power(power);
      std::vector<double> const weights = weighted(next - power, estimate.log_evidence);
      if (weights.empty()) break;
      resample(weights);
      power = next;
      if (power < 1) move(power, most);
    }
    estimate.simulations = simulations_;
    estimate.finished = power >= 1;
    describe(estimate);
    return estimate;
  }

 private:
  void evaluate(LaneArray const& theta, std::vector<double>& log_prior, std::vector<double>& log_likelihood) {
    constexpr int block = 512;
    log_prior.assign(static_cast<std::size_t>(theta.width()), 0.0);
    log_likelihood.assign(log_prior.size(), -infinity);
    target_.log_prior(theta, log_prior);
    for (int first = 0; first < theta.width() && !(stop_ && stop_()); first += block) {
      int const count = std::min(block, theta.width() - first);
      target_.log_likelihood(theta.view().columns(first, count),
                             std::span(log_likelihood).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)),
                             ledger_);
    }
    for (std::size_t w = 0; w < log_prior.size(); ++w)
      if (!std::isfinite(log_prior[w]) || !std::isfinite(log_likelihood[w])) log_likelihood[w] = -infinity;
    simulations_ += log_prior.size();
  }

  /// log of the mean weight is added to `log_evidence`; empty where no particle has a likelihood.
  std::vector<double> weighted(double rise, double& log_evidence) const {
    double const highest = *std::max_element(all_.log_likelihood.begin(), all_.log_likelihood.end());
    if (!std::isfinite(highest)) return {};
    std::vector<double> weights;
    double sum = 0;
    for (double const each : all_.log_likelihood) {
      weights.push_back(std::isfinite(each) ? elementary::exp(rise * (each - highest)) : 0);
      sum += weights.back();
    }
    log_evidence += rise * highest + elementary::log(sum / static_cast<double>(weights.size()));
    return weights;
  }

  double next_power(double power) const {
    auto const effective = [&](double rise) {
      double ignored = 0, sum = 0, square = 0;
      for (double const each : weighted(rise, ignored)) sum += each, square += each * each;
      return square > 0 ? sum * sum / square : 0;
    };
    // Particles without a likelihood are lost with the first step, however small it is.
    auto const alive =
        std::count_if(all_.log_likelihood.begin(), all_.log_likelihood.end(), [](double each) { return std::isfinite(each); });
    double const wanted = worth * static_cast<double>(alive);
    if (effective(1 - power) >= wanted) return 1;
    double low = 0, high = 1 - power;
    for (int k = 0; k < 60; ++k) {
      double const middle = 0.5 * (low + high);
      (effective(middle) >= wanted ? low : high) = middle;
    }
    return power + std::max(low, 1e-12);
  }

  void resample(std::vector<double> const& weights) {
    double sum = 0;
    for (double const each : weights) sum += each;
    // Independently of each other, as the variance of the evidence assumes.
    Stream stream({seed_, Purpose::evidence, step_, resampling_step});
    std::vector<double> places;
    for (std::size_t w = 0; w < weights.size(); ++w) places.push_back(stream.uniform() * sum);
    std::sort(places.begin(), places.end());
    Particles next{LaneArray(all_.theta.rows(), all_.theta.width()), {}, {}, {}};
    double passed = weights.front();
    std::size_t from = 0;
    for (std::size_t w = 0; w < weights.size(); ++w) {
      while (passed < places[w] && from + 1 < weights.size()) passed += weights[++from];
      for (int p = 0; p < next.theta.rows(); ++p) next.theta(p, static_cast<int>(w)) = all_.theta(p, static_cast<int>(from));
      next.log_prior.push_back(all_.log_prior[from]);
      next.log_likelihood.push_back(all_.log_likelihood[from]);
      next.ancestor.push_back(all_.ancestor[from]);
    }
    all_ = std::move(next);
    ++step_;
  }

  /// Until a particle has moved with probability 0.98, as far as the acceptance rates so far say.
  void move(double power, std::uint64_t most) {
    Mixture const mixture = fit_mixture({}, all_.theta, seed_, stop_);
    double kept = 1;
    int moves = 0;
    while (!(stop_ && stop_()) && simulations_ + all_.size() <= most &&
           (moves < least_moves || (kept > 0.02 && moves < most_moves))) {
      double const rate = moves % 2 == 0 && !mixture.empty() ? jump(mixture, power) : walk(mixture, power);
      kept *= 1 - rate;
      ++moves;
    }
  }

  double jump(Mixture const& mixture, double power) {
    ++move_;
    LaneArray proposed(all_.theta.rows(), all_.theta.width());
    for (int w = 0; w < proposed.width(); ++w)
      mixture.draw({seed_, Purpose::evidence, static_cast<std::uint64_t>(w), smc_step + move_}, proposed, w);
    std::vector<double> const from = mixture.log_density(mixture.log_terms(all_.theta)),
                              to = mixture.log_density(mixture.log_terms(proposed));
    std::vector<double> log_ratio(from.size());
    for (std::size_t w = 0; w < from.size(); ++w) log_ratio[w] = from[w] - to[w];
    return decide(proposed, log_ratio, power);
  }

  /// Steps of the shape of any component.
  double walk(Mixture const& mixture, double power) {
    if (mixture.empty()) return 0;
    LaneArray proposed(all_.theta.rows(), all_.theta.width());
    std::size_t const parts = mixture.parts().size();
    double const length = scale_ * 2.38 / std::sqrt(static_cast<double>(proposed.rows()));
    ++move_;
    for (int w = 0; w < proposed.width(); ++w) {
      Stream stream({seed_, Purpose::evidence, static_cast<std::uint64_t>(w), smc_step + move_});
      Component const& shape = mixture.parts()[stream.below(parts)].shape;
      Eigen::VectorXd const step = length * shape.move(stream, false);
      for (int p = 0; p < proposed.rows(); ++p) proposed(p, w) = all_.theta(p, w) + step(p);
    }
    double const rate = decide(proposed, std::vector<double>(all_.size(), 0.0), power);
    scale_ *= elementary::exp(std::clamp(2 * (rate - 0.234), -0.5, 0.5));
    return rate;
  }

  /// Share of the moves that were accepted.
  double decide(LaneArray const& proposed, std::vector<double> const& log_ratio, double power) {
    std::vector<double> log_prior, log_likelihood;
    evaluate(proposed, log_prior, log_likelihood);
    double accepted = 0;
    for (std::size_t w = 0; w < all_.size(); ++w) {
      Stream stream({seed_, Purpose::accept, w, smc_step + move_});
      double const log_chance =
          log_prior[w] - all_.log_prior[w] + power * (log_likelihood[w] - all_.log_likelihood[w]) + log_ratio[w];
      if (!(elementary::log(stream.uniform()) < log_chance)) continue;
      for (int p = 0; p < proposed.rows(); ++p) all_.theta(p, static_cast<int>(w)) = proposed(p, static_cast<int>(w));
      all_.log_prior[w] = log_prior[w];
      all_.log_likelihood[w] = log_likelihood[w];
      ++accepted;
    }
    return accepted / static_cast<double>(all_.size());
  }

  void describe(SmcEstimate& estimate) const {
    std::vector<double> descendants(all_.size(), 0.0);
    for (std::size_t const each : all_.ancestor) ++descendants[each];
    auto const n = static_cast<double>(all_.size());
    double same = 0;  // chance that two particles have one ancestor
    for (double const each : descendants) same += each * each / (n * n);
    estimate.effective = 1 / same;
    double const variance = 1 - elementary::exp(static_cast<double>(step_ + 1) * elementary::log(n / (n - 1))) * (1 - same);
    // Below what independent particles would have it is chance.
    estimate.error = std::sqrt(std::max(variance, 1 / n));
  }

  Target const& target_;
  std::uint64_t seed_;
  Ledger& ledger_;
  std::function<bool()> const& stop_;
  Particles all_;
  std::uint64_t simulations_ = 0, step_ = 0, move_ = 0;
  double scale_ = 1;
};

}  // namespace

SmcEstimate smc(Target const& target, int particles, std::uint64_t most_simulations, std::uint64_t seed, Ledger& ledger,
                std::function<bool()> const& stop) {
  if (most_simulations < static_cast<std::uint64_t>(2 * particles)) return {};
  return Tempering(target, particles, seed, ledger, stop).run(most_simulations);
}

}  // namespace sysid::marginal
