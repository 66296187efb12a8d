// Windows of burn-in, and what each says of the independence moves.
#include "inference/chain/independence_learning.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "inference/backend/checkpoint.hpp"
#include "search/laplace.hpp"

namespace sysid::metropolis {
namespace {

/// Iterations; shorter ones tell little of a covariance.
constexpr std::uint64_t shortest_window = 100;
/// Cycles from one trial to the next where independence moves are not accepted.
constexpr std::uint64_t trial_interval = 8;
/// Laplace's shares may be far off: each mode is visited.
constexpr double least_weight = 0.02;

constexpr int most_moves = 15;
/// Independence moves that a chain spends in one place at most, between two moves of the random walk that lead out of it.
constexpr double longest_wait = 30;

}  // namespace

void IndependenceLearning::Fit::add(double log_posterior, double log_q, bool first) {
  double const log_weight = log_posterior - log_q;
  log_density += log_q;
  log_highest = first ? log_weight : std::max(log_highest, log_weight);
  log_inverse = first ? -log_weight : log_of_sum(log_inverse, -log_weight);
}

IndependenceLearning::IndependenceLearning(std::vector<Mode> const& modes, std::vector<int> component_of_chain)
    : component_of_chain_(std::move(component_of_chain)) {
  std::vector<Independence::Component> components;
  for (Mode const& mode : modes) {
    weights_.push_back(std::max(mode.share, least_weight));
    components.push_back({weights_.back(), theta_of(mode), covariance_of(mode)});
  }
  current_ = candidate_ = Independence(components);
}

// A move of the random walk is worth 0.33 / P independent draws at best (Gelman, Roberts and Gilks 1996), an independence move at
// most its chance of being accepted. But in a place that the mixture hardly reaches a chain stays for long, and the walk must lead
// out of it. Between separate modes nothing but independence moves leads.
int IndependenceLearning::worth() const {
  int const few = weights_.size() > 1 && acceptance_ >= 0.01 ? 1 : 0;
  if (acceptance_ < 0.1) return few;
  int const by_acceptance = acceptance_ >= 0.5 ? most_moves : acceptance_ >= 0.25 ? 7 : 3;
  return std::max(few, std::min(by_acceptance, static_cast<int>(longest_wait / longest_stay_)));
}

int IndependenceLearning::moves_in_burn_in() const {
  if (!active()) return 0;
  if (windows_ == 0) return 3;
  int const moves = worth();
  return moves > 0 ? moves : cycles_ % trial_interval == 0 ? 1 : 0;
}

int IndependenceLearning::moves() const { return active() && windows_ > 0 ? worth() : 0; }

std::vector<char> IndependenceLearning::away(State const& state) const {
  std::vector<char> is_away(component_of_chain_.size(), 0);
  for (std::size_t w = 0; weights_.size() > 1 && w < is_away.size(); ++w)
    is_away[w] = current_.nearest(state.theta, static_cast<int>(w)) != component_of_chain_[w];
  return is_away;
}

void IndependenceLearning::learn(State const& state, Info const& info) {
  ++iterations_;
  ++window_.iterations;
  std::vector<double> of_current(info.size()), of_candidate(info.size());
  current_.log_density(state.theta, of_current);
  candidate_.log_density(state.theta, of_candidate);
  for (int w = 0; w < state.theta.width(); ++w) {
    double const now = of_current[static_cast<std::size_t>(w)], then = of_candidate[static_cast<std::size_t>(w)];
    double const density = state.log_prior[static_cast<std::size_t>(w)] + state.log_likelihood[static_cast<std::size_t>(w)];
    if (std::isfinite(now) && std::isfinite(then) && std::isfinite(density)) {
      window_.current.add(density, now, window_.states == 0);
      window_.candidate.add(density, then, window_.states == 0);
      ++window_.states;
    }
    Move const& move = info[static_cast<std::size_t>(w)];
    if (!move.independent) continue;
    window_.acceptance += move.acceptance_probability;
    ++window_.moves;
  }
}

void IndependenceLearning::end_cycle(std::span<Adaptation const> groups) {
  ++cycles_;
  if (window_.iterations < std::max(shortest_window, iterations_ / 4)) return;
  bool const better = window_.candidate.log_density > window_.current.log_density;
  if (better) current_ = candidate_;
  if (window_.states > 0) {
    // E w over q is 1 / E(1 / w) over p, of which the states are.
    Fit const& fit = better ? window_.candidate : window_.current;
    longest_stay_ = elementary::exp(fit.log_highest + fit.log_inverse) / static_cast<double>(window_.states);
  }
  if (window_.moves > 0) acceptance_ = window_.acceptance / static_cast<double>(window_.moves);
  ++windows_;
  window_ = {};
  std::vector<Independence::Component> components;
  for (std::size_t k = 0; k < weights_.size(); ++k)
    for (Adaptation const& group : groups)
      if (component_of_chain_[static_cast<std::size_t>(group.chains().front())] == static_cast<int>(k))
        components.push_back({weights_[k], group.mean(), group.covariance()});
  // Modes without a chain have nothing new: a candidate that lost them would lose the posterior's mass there.
  if (components.size() == weights_.size()) candidate_ = Independence(components);
}

nlohmann::json IndependenceLearning::store() const {
  return {{"component_of_chain", component_of_chain_},
          {"weights", checkpoint::encode(std::span<double const>(weights_))},
          {"current", current_.store()},
          {"candidate", candidate_.store()},
          {"counts", {window_.iterations, window_.states, window_.moves, iterations_, cycles_, windows_}},
          {"sums",
           checkpoint::encode(std::vector<double>{
               window_.current.log_density, window_.current.log_highest, window_.current.log_inverse, window_.candidate.log_density,
               window_.candidate.log_highest, window_.candidate.log_inverse, window_.acceptance, acceptance_, longest_stay_})}};
}

IndependenceLearning IndependenceLearning::restore(nlohmann::json const& stored, int dimension) {
  IndependenceLearning all;
  all.component_of_chain_ = stored.at("component_of_chain").get<std::vector<int>>();
  all.weights_ = checkpoint::decode(stored.at("weights"));
  all.current_ = Independence::restore(stored.at("current"), dimension);
  all.candidate_ = Independence::restore(stored.at("candidate"), dimension);
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  std::vector<double> const sums = checkpoint::decode(stored.at("sums"), 9);
  if (counts.size() != 6) throw checkpoint::Mismatch("its independence moves differ in form");
  all.window_ = {counts[0], counts[1], counts[2], {sums[0], sums[1], sums[2]}, {sums[3], sums[4], sums[5]}, sums[6]};
  all.iterations_ = counts[3];
  all.cycles_ = counts[4];
  all.windows_ = counts[5];
  all.acceptance_ = sums[7];
  all.longest_stay_ = sums[8];
  return all;
}

}  // namespace sysid::metropolis
