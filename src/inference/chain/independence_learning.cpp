// Windows of burn-in, and what each says of the independence moves.
#include "inference/chain/independence_learning.hpp"

#include <algorithm>
#include <cmath>

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

/// A move of the random walk is worth 0.33 / P independent draws at best (Gelman, Roberts and Gilks 1996), an independence move at
/// most its chance of being accepted; but where that is small, chains stay for long in places that the mixture hardly reaches, and
/// the walk must lead out of them. Between separate modes nothing else leads.
int moves_for(double acceptance, bool several_modes) {
  if (acceptance >= 0.5) return 15;
  if (acceptance >= 0.25) return 7;
  if (acceptance >= 0.1) return 3;
  return several_modes && acceptance >= 0.01 ? 1 : 0;
}

}  // namespace

IndependenceLearning::IndependenceLearning(std::vector<Mode> const& modes, std::vector<int> component_of_chain)
    : component_of_chain_(std::move(component_of_chain)) {
  std::vector<Independence::Component> components;
  for (Mode const& mode : modes) {
    weights_.push_back(std::max(mode.share, least_weight));
    components.push_back({weights_.back(), theta_of(mode), covariance_of(mode)});
  }
  current_ = candidate_ = Independence(components);
}

int IndependenceLearning::moves_in_burn_in() const {
  if (!active()) return 0;
  if (windows_ == 0) return 3;
  int const worth = moves_for(acceptance_, weights_.size() > 1);
  return worth > 0 ? worth : cycles_ % trial_interval == 0 ? 1 : 0;
}

int IndependenceLearning::moves() const { return active() && windows_ > 0 ? moves_for(acceptance_, weights_.size() > 1) : 0; }

std::vector<char> IndependenceLearning::away(State const& state) const {
  std::vector<char> is_away(component_of_chain_.size(), 0);
  for (std::size_t w = 0; weights_.size() > 1 && w < is_away.size(); ++w)
    is_away[w] = current_.nearest(state.theta, static_cast<int>(w)) != component_of_chain_[w];
  return is_away;
}

void IndependenceLearning::learn(State const& state, Info const& info) {
  ++iterations_;
  ++window_.iterations;
  for (int w = 0; w < state.theta.width(); ++w) {
    double const now = current_.log_density(state.theta, w), then = candidate_.log_density(state.theta, w);
    if (std::isfinite(now) && std::isfinite(then)) {
      window_.current += now;
      window_.candidate += then;
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
  if (window_.candidate > window_.current) current_ = candidate_;
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
          {"sums", checkpoint::encode(std::vector<double>{window_.current, window_.candidate, window_.acceptance, acceptance_})}};
}

IndependenceLearning IndependenceLearning::restore(nlohmann::json const& stored, int dimension) {
  IndependenceLearning all;
  all.component_of_chain_ = stored.at("component_of_chain").get<std::vector<int>>();
  all.weights_ = checkpoint::decode(stored.at("weights"));
  all.current_ = Independence::restore(stored.at("current"), dimension);
  all.candidate_ = Independence::restore(stored.at("candidate"), dimension);
  auto const counts = stored.at("counts").get<std::vector<std::uint64_t>>();
  std::vector<double> const sums = checkpoint::decode(stored.at("sums"), 4);
  if (counts.size() != 6) throw checkpoint::Mismatch("its independence moves differ in form");
  all.window_ = {counts[0], counts[1], counts[2], sums[0], sums[1], sums[2]};
  all.iterations_ = counts[3];
  all.cycles_ = counts[4];
  all.windows_ = counts[5];
  all.acceptance_ = sums[3];
  return all;
}

}  // namespace sysid::metropolis
