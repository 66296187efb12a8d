// Reweighting, resampling and moves of a population between prior and posterior.
#include "inference/evidence/smc.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/evidence/mixture.hpp"
#include "search/laplace.hpp"
#include "search/local_searches.hpp"

namespace sysid::marginal {
namespace {

constexpr std::uint64_t smc_step = 2'000'000;  // of Purpose::evidence; moves count on from it
constexpr std::uint64_t resampling_step = 1'500'000;
constexpr int least_moves = 4, most_moves = 60;  // per power
constexpr double worth = 0.5;                    // of the particles, after a weighting
constexpr double forgotten = 0.15;               // correlation of ranks with those before the moves
constexpr double hardly_moved = 0.5;             // the same after all moves, from which the particles are still where they were
constexpr int climbed = 16;                      // of the first particles, where no modes are known
constexpr double mode_share = 0.2;               // of the proposals

/// Of values, 0 to n - 1; centred.
std::vector<double> ranks(std::vector<double> const& values) {
  std::vector<std::size_t> order(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b] || (values[a] == values[b] && a < b); });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    rank[order[i]] = static_cast<double>(i) - 0.5 * static_cast<double>(order.size() - 1);
  return rank;
}

double correlation(std::vector<double> const& a, std::vector<double> const& b) {
  double ab = 0, aa = 0;
  for (std::size_t i = 0; i < a.size(); ++i) ab += a[i] * b[i], aa += a[i] * a[i];
  return aa > 0 ? ab / aa : 0;
}

struct Particles {
  LaneArray theta;
  std::vector<double> log_prior, log_likelihood;
  std::vector<std::size_t> ancestor;  // among the first ones

  std::size_t size() const { return log_prior.size(); }
};

class Tempering {
 public:
  Tempering(Target const& target, int particles, std::vector<Mode> modes, std::uint64_t seed, Ledger& ledger,
            std::function<bool()> const& stop)
      : target_(target),
        seed_(seed),
        ledger_(ledger),
        stop_(stop),
        modes_(std::move(modes)),
        all_{LaneArray(target.dimension(), particles), {}, {}, {}} {
    target.sample_prior({seed, Purpose::evidence, 0, smc_step - 1}, all_.theta);
    evaluate(all_.theta, all_.log_prior, all_.log_likelihood);
    for (std::size_t w = 0; w < all_.size(); ++w) all_.ancestor.push_back(w);
    widths_ = make_objective(target, ObjectiveKind::posterior, all_.theta).scale;
    if (modes_.empty()) find_modes();
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
    estimate.unmoved = unmoved_;
    describe(estimate);
    return estimate;
  }

 private:
  /// Those that the likeliest of the first particles climb to.
  void find_modes() {
    std::vector<std::size_t> order(all_.size());
    for (std::size_t w = 0; w < order.size(); ++w) order[w] = w;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return all_.log_likelihood[a] > all_.log_likelihood[b]; });
    LaneArray starts(all_.theta.rows(), climbed);
    for (int k = 0; k < climbed; ++k)
      for (int p = 0; p < starts.rows(); ++p) starts(p, k) = all_.theta(p, static_cast<int>(order[static_cast<std::size_t>(k)]));
    std::uint64_t const before = ledger_.solves();
    modes_ = modes_from(target_, ObjectiveKind::posterior, starts, -infinity, seed_, ledger_, stop_).modes;
    simulations_ += ledger_.solves() - before;
  }

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
      double ignored = 0;
      return effective_number(weighted(rise, ignored));
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

  /// Until the particles have forgotten where they were: each coordinate, and the likelihood.
  void move(double power, std::uint64_t most) {
    Mixture const mixture = with_modes(fit_mixture({}, all_.theta, seed_, stop_), power);
    if (mixture.empty()) {
      unmoved_ = true;
      return;
    }
    std::vector<std::vector<double>> const before = ranked();
    double kept = 1;
    for (int moves = 0; moves < least_moves || (kept > forgotten && moves < most_moves); ++moves) {
      if ((stop_ && stop_()) || simulations_ + all_.size() > most) return;
      if (moves % 2 == 0)
        jump(mixture, power);
      else
        walk(mixture, power);
      kept = 0;
      std::vector<std::vector<double>> const now = ranked();
      for (std::size_t k = 0; k < now.size(); ++k) kept = std::max(kept, correlation(before[k], now[k]));
    }
    if (kept > hardly_moved) unmoved_ = true;
  }

  void jump(Mixture const& mixture, double power) {
    ++move_;
    LaneArray proposed(all_.theta.rows(), all_.theta.width());
    for (int w = 0; w < proposed.width(); ++w)
      mixture.draw({seed_, Purpose::evidence, static_cast<std::uint64_t>(w), smc_step + move_}, proposed, w);
    std::vector<double> const from = mixture.log_density(mixture.log_terms(all_.theta)),
                              to = mixture.log_density(mixture.log_terms(proposed));
    std::vector<double> log_ratio(from.size());
    for (std::size_t w = 0; w < from.size(); ++w) log_ratio[w] = from[w] - to[w];
    decide(proposed, log_ratio, power);
  }

  /// Modes as wide as the power leaves them beside what is fitted.
  Mixture with_modes(Mixture const& fitted, double power) const {
    if (modes_.empty()) return fitted;
    std::vector<Mixture::Part> parts = fitted.parts();
    double const share = fitted.empty() ? 1 : mode_share;
    for (Mixture::Part& part : parts) part.normal *= 1 - share, part.student *= 1 - share;
    for (Mode const& mode : modes_) {
      double const each = 0.5 * share / static_cast<double>(modes_.size());
      parts.push_back({Component(theta_of(mode), covariance_at_power(mode, power, widths_)), each, each, true});
    }
    return Mixture(std::move(parts));
  }

  std::vector<std::vector<double>> ranked() const {
    std::vector<std::vector<double>> all;
    for (int p = 0; p < all_.theta.rows(); ++p) {
      auto const row = all_.theta.row(p);
      all.push_back(ranks({row.begin(), row.end()}));
    }
    all.push_back(ranks(all_.log_likelihood));
    return all;
  }

  /// The shares that the parts have at each particle [parts][W].
  std::vector<std::vector<double>> shares(Mixture const& mixture, LaneArray const& theta) const {
    LaneArray const terms = mixture.log_terms(theta);
    std::vector<double> const log_shares = mixture.log_shares(), total = mixture.log_density(terms);
    std::vector<std::vector<double>> out(mixture.parts().size(), std::vector<double>(total.size()));
    for (std::size_t k = 0; k < out.size(); ++k)
      for (std::size_t w = 0; w < total.size(); ++w) {
        double sum = 0;
        for (std::size_t i : {2 * k, 2 * k + 1})
          if (std::isfinite(log_shares[i]))
            sum += elementary::exp(log_shares[i] + terms(static_cast<int>(i), static_cast<int>(w)) - total[w]);
        out[k][w] = sum;
      }
    return out;
  }

  /// Steps of the shape of the component that a particle belongs to: where the posterior is a funnel, of its width there.
  void walk(Mixture const& mixture, double power) {
    LaneArray proposed(all_.theta.rows(), all_.theta.width());
    std::size_t const parts = mixture.parts().size();
    double const length = scale_ * 2.38 / std::sqrt(static_cast<double>(proposed.rows()));
    ++move_;
    std::vector<std::vector<double>> const from = shares(mixture, all_.theta);
    std::vector<Eigen::VectorXd> steps;
    for (int w = 0; w < proposed.width(); ++w) {
      Stream stream({seed_, Purpose::evidence, static_cast<std::uint64_t>(w), smc_step + move_});
      double place = stream.uniform();
      std::size_t k = 0;
      while (k + 1 < parts && (place -= from[k][static_cast<std::size_t>(w)]) > 0) ++k;
      steps.push_back(mixture.parts()[k].shape.move(stream, false));
      for (int p = 0; p < proposed.rows(); ++p) proposed(p, w) = all_.theta(p, w) + length * steps.back()(p);
    }
    std::vector<std::vector<double>> const to = shares(mixture, proposed);
    std::vector<double> log_ratio;
    for (std::size_t w = 0; w < all_.size(); ++w) {
      double ahead = 0, back = 0;  // densities of the step, over that of the widest
      std::vector<double> log_density;
      for (Mixture::Part const& part : mixture.parts())
        log_density.push_back(part.shape.log_density(part.shape.centre + steps[w]).normal);
      double const highest = *std::max_element(log_density.begin(), log_density.end());
      for (std::size_t k = 0; k < parts; ++k) {
        double const density = elementary::exp(log_density[k] - highest);
        ahead += from[k][w] * density, back += to[k][w] * density;
      }
      log_ratio.push_back(ahead > 0 && back > 0 ? elementary::log(back / ahead) : -infinity);
    }
    double const rate = decide(proposed, log_ratio, power);
    scale_ *= elementary::exp(std::clamp(2 * (rate - 0.234), -0.5, 0.5));
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
  std::vector<Mode> modes_;
  Particles all_;
  Eigen::VectorXd widths_;  // of the prior
  std::uint64_t simulations_ = 0, step_ = 0, move_ = 0;
  double scale_ = 1;
  bool unmoved_ = false;
};

}  // namespace

SmcEstimate smc(Target const& target, int particles, std::vector<Mode> const& modes, std::uint64_t most_simulations,
                std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop) {
  if (most_simulations < static_cast<std::uint64_t>(2 * particles)) return {};
  return Tempering(target, particles, modes, seed, ledger, stop).run(most_simulations);
}

}  // namespace sysid::marginal
