// A run as a JSON value, and back.
#include "inference/jump/state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::jump {
namespace {

using json = nlohmann::json;

json block(std::vector<double> const& values) { return checkpoint::encode(std::span<double const>(values)); }

json counts(State const& state) {
  json all = json::array();
  for (auto const* each : {&state.bias, &state.scale, &state.visits, &state.walks, &state.walks_accepted, &state.jumps_in,
                           &state.jumps_in_accepted, &state.jumps_out, &state.jumps_out_accepted})
    all.push_back(block(*each));
  return all;
}

void restore_counts(json const& stored, std::size_t models, State& state) {
  std::size_t i = 0;
  for (auto* each : {&state.bias, &state.scale, &state.visits, &state.walks, &state.walks_accepted, &state.jumps_in,
                     &state.jumps_in_accepted, &state.jumps_out, &state.jumps_out_accepted})
    *each = checkpoint::decode(stored.at(i++), models);
  if (std::any_of(state.scale.begin(), state.scale.end(), [](double each) { return !(each > 0 && each < infinity); }) ||
      std::any_of(state.bias.begin(), state.bias.end(), [](double each) { return !std::isfinite(each); }))
    throw checkpoint::Mismatch("its weights of models are no numbers");
}

json store(Place const& place) { return {place.model, block(place.theta), block({place.log_density, place.log_proposal})}; }

Place restore_place(json const& stored, std::vector<int> const& dimensions) {
  Place place;
  place.model = stored.at(0).get<int>();
  if (place.model < 0 || place.model >= static_cast<int>(dimensions.size()))
    throw checkpoint::Mismatch("a chain is in a model that does not exist");
  place.theta = checkpoint::decode(stored.at(1), static_cast<std::size_t>(dimensions[static_cast<std::size_t>(place.model)]));
  std::vector<double> const logs = checkpoint::decode(stored.at(2), 2);
  place.log_density = logs[0];
  place.log_proposal = logs[1];
  if (!std::isfinite(logs[0]) || !std::isfinite(logs[1])) throw checkpoint::Mismatch("a chain is at a place without a density");
  return place;
}

void restore_live(json const& stored, std::span<LikelihoodCandidate const> candidates, Plan const& plan, State& state) {
  state.live = stored.at("live").get<std::vector<int>>();
  std::vector<int> dimensions;
  for (std::size_t i = 0; i < state.live.size(); ++i) {
    int const candidate = state.live[i];
    if (candidate < 0 || candidate >= static_cast<int>(candidates.size()) || (i > 0 && candidate <= state.live[i - 1]))
      throw checkpoint::Mismatch("its models are not the candidates");
    auto const& pilot = state.pilots[static_cast<std::size_t>(candidate)];
    if (!pilot || !pilot->excluded.empty()) throw checkpoint::Mismatch("a model jumps without a pilot");
    dimensions.push_back(candidates[static_cast<std::size_t>(candidate)].target->dimension());
  }
  auto const models = state.live.size();
  if (models == 0) return;
  restore_counts(stored.at("counts"), models, state);
  state.next = stored.at("next").get<std::uint64_t>();
  if (state.next > plan.samples) throw checkpoint::Mismatch("it has more iterations than the run");
  for (json const& each : stored.at("places")) state.places.push_back(restore_place(each, dimensions));
  bool const placed = state.next > 0 || !state.places.empty();
  if (placed && std::ssize(state.places) != plan.chains) throw checkpoint::Mismatch("its chains differ in number");
  state.burn_in = restore_tally(stored.at("burn_in"), static_cast<int>(models), plan.chains, 1);
  state.tally = restore_tally(stored.at("tally"), static_cast<int>(models), plan.chains, static_cast<int>(plan.parts()));
  state.simulations = stored.at("simulations").get<std::vector<std::uint64_t>>();
  if (state.simulations.size() != models) throw checkpoint::Mismatch("its models differ in number");
  for (std::size_t m = 0; m < models; ++m) {
    std::vector<double> const weights = checkpoint::decode(stored.at("weights").at(m), 4);
    state.weights.push_back({weights[0], weights[1], weights[2], weights[3]});
    json const& draws = stored.at("draws").at(m);
    state.draws.push_back({checkpoint::decode(draws.at(0)), checkpoint::decode(draws.at(1))});
    if (state.draws[m].theta.size() != state.draws[m].log_density.size() * static_cast<std::size_t>(dimensions[m]))
      throw checkpoint::Mismatch("its draws differ in dimension");
  }
}

}  // namespace

void Weights::add(double log_weight) {
  ++count;
  if (log_weight == -infinity) return;
  if (sum == 0) highest = log_weight;
  if (log_weight > highest) {
    double const less = elementary::exp(highest - log_weight);
    sum *= less;
    squares *= less * less;
    highest = log_weight;
  }
  double const weight = elementary::exp(log_weight - highest);
  sum += weight;
  squares += weight * weight;
}

double Weights::log_mean() const { return sum > 0 ? highest + elementary::log(sum / count) : -infinity; }

double Weights::error() const {
  if (!(sum > 0) || count < 2) return infinity;
  return std::sqrt(std::max(0.0, squares / (sum * sum) - 1 / count));
}

double Weights::worth() const { return sum > 0 ? sum * sum / squares / count : 0; }

json identity(std::span<LikelihoodCandidate const> candidates, Settings const& settings, std::uint64_t seed) {
  json models = json::array();
  for (LikelihoodCandidate const& each : candidates) {
    json parameters = json::array();
    for (ParameterInfo const& parameter : each.target->parameters()) parameters.push_back(parameter.name);
    models.push_back({each.name, each.prior, parameters, each.excluded.empty()});
  }
  return checkpoint::identity("reversible_jump", settings, seed, std::move(models));
}

json store(State const& state, json const& identity, Ledger const& ledger) {
  json pilots = json::array(), places = json::array(), weights = json::array(), draws = json::array();
  for (auto const& pilot : state.pilots) pilots.push_back(pilot ? store(*pilot) : json());
  for (Place const& each : state.places) places.push_back(store(each));
  for (Weights const& each : state.weights) weights.push_back(block({each.highest, each.sum, each.squares, each.count}));
  for (KeptDraws const& each : state.draws) draws.push_back({block(each.theta), block(each.log_density)});
  return {{"identity", identity},
          {"pilots", std::move(pilots)},
          {"chains_of_pilot", state.chains_of_pilot},
          {"live", state.live},
          {"counts", counts(state)},
          {"next", state.next},
          {"places", std::move(places)},
          {"burn_in", store(state.burn_in)},
          {"tally", store(state.tally)},
          {"weights", std::move(weights)},
          {"draws", std::move(draws)},
          {"simulations", state.simulations},
          {"ledger", checkpoint::encode(ledger)}};
}

State restore(json const& stored, std::span<LikelihoodCandidate const> candidates, Plan const& plan, Ledger& ledger) {
  State state;
  if (stored.at("pilots").size() != candidates.size()) throw checkpoint::Mismatch("its pilots differ in number");
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    json const& pilot = stored.at("pilots").at(k);
    state.pilots.push_back(pilot.is_null() ? std::optional<Pilot>() : restore_pilot(pilot, candidates[k].target->dimension()));
  }
  state.chains_of_pilot = stored.at("chains_of_pilot");
  restore_live(stored, candidates, plan, state);
  ledger = checkpoint::decode_ledger(stored.at("ledger"));
  return state;
}

}  // namespace sysid::jump
