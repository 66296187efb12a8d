// States to JSON and back.
#include "inference/abc/state.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "inference/backend/checkpoint.hpp"

namespace sysid::abc {
namespace {

using json = nlohmann::json;

json block(std::vector<double> const& values) { return checkpoint::encode(std::span<double const>(values)); }

std::vector<double> numbers(Eigen::MatrixXd const& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

json store(Particles const& particles) {
  return {block(particles.at), block(particles.log_prior), block(particles.distance), block(particles.weight)};
}

Particles restore_particles(json const& stored, int dimension) {
  Particles particles{checkpoint::decode(stored.at(0)), checkpoint::decode(stored.at(1)), checkpoint::decode(stored.at(2)),
                      checkpoint::decode(stored.at(3))};
  auto const count = particles.distance.size();
  if (particles.at.size() != count * static_cast<std::size_t>(dimension) || particles.log_prior.size() != count ||
      particles.weight.size() != count)
    throw checkpoint::Mismatch("its particles differ in number or dimension");
  return particles;
}

json store(Population const& population) {
  json models = json::array(), widths = json::array();
  for (Particles const& each : population.models) models.push_back(store(each));
  for (Width const& each : population.widths) widths.push_back({block(numbers(each.covariance)), block(numbers(each.range))});
  return {{"number", population.number},
          {"threshold", block({population.threshold})},
          {"models", std::move(models)},
          {"widths", std::move(widths)}};
}

Population restore_population(json const& stored, SelectionTarget const& candidates) {
  Population population;
  population.number = stored.at("number").get<int>();
  population.threshold = checkpoint::decode(stored.at("threshold"), 1).front();
  for (int m = 0; m < candidates.size(); ++m) {
    auto const at = static_cast<std::size_t>(m);
    int const dimension = candidates.dimension(m);
    population.models.push_back(restore_particles(stored.at("models").at(at), dimension));
    std::vector<double> const covariance = checkpoint::decode(stored.at("widths").at(at).at(0)),
                              range = checkpoint::decode(stored.at("widths").at(at).at(1));
    if (range.size() != static_cast<std::size_t>(dimension) || covariance.size() != range.size() * range.size())
      throw checkpoint::Mismatch("its kernels differ in dimension");
    population.widths.push_back({Eigen::Map<Eigen::MatrixXd const>(covariance.data(), dimension, dimension),
                                 Eigen::Map<Eigen::VectorXd const>(range.data(), dimension)});
  }
  return population;
}

json store(PopulationRecord const& record) {
  json models = json::array();
  for (auto const& each : record.models)
    models.push_back({each.proposed, each.failed, each.particles, block({each.probability, each.nearest})});
  return {{"numbers", block({record.threshold, record.ess})},
          {"counts", {record.proposed, record.simulated, record.failed, record.accepted}},
          {"models", std::move(models)}};
}

PopulationRecord restore_record(json const& stored, int models) {
  PopulationRecord record;
  std::vector<double> const pair = checkpoint::decode(stored.at("numbers"), 2);
  record.threshold = pair.at(0);
  record.ess = pair.at(1);
  auto const& counts = stored.at("counts");
  record.proposed = counts.at(0).get<std::uint64_t>();
  record.simulated = counts.at(1).get<std::uint64_t>();
  record.failed = counts.at(2).get<std::uint64_t>();
  record.accepted = counts.at(3).get<int>();
  for (auto const& model : stored.at("models")) {
    std::vector<double> const two = checkpoint::decode(model.at(3), 2);
    record.models.push_back(
        {model.at(0).get<std::uint64_t>(), model.at(1).get<std::uint64_t>(), model.at(2).get<int>(), two.at(0), two.at(1)});
  }
  if (std::ssize(record.models) != models) throw checkpoint::Mismatch("its populations differ in models");
  return record;
}

/// Whether populations follow each other as a run makes them: each whole one has a record, and particles.
bool in_order(State const& state) {
  Population const& last = state.last;
  return last.number >= 0 && state.next.number == last.number + 1 && std::ssize(state.records) == last.number &&
         (last.number == 0 ||
          std::any_of(last.models.begin(), last.models.end(), [](Particles const& each) { return each.count() > 0; }));
}

/// Whether models have as many particles as the record of their population counts, and one of those has a probability.
bool counted(Population const& population, PopulationRecord const& record) {
  bool probable = false;
  for (std::size_t m = 0; m < record.models.size(); ++m) {
    int const count = population.models[m].count();
    double const probability = record.models[m].probability;
    if (record.models[m].particles != count || !(probability >= 0) || (probability > 0 && count == 0)) return false;
    probable = probable || probability > 0;
  }
  return probable;
}

}  // namespace

std::uint64_t State::simulations() const {
  std::uint64_t sum = 0;
  for (PopulationRecord const& each : records) sum += each.simulated;
  return sum;
}

json identity(SelectionTarget const& candidates, Settings const& settings, std::uint64_t seed) {
  json models = json::array();
  for (int m = 0; m < candidates.size(); ++m) {
    json parameters = json::array();
    for (ParameterInfo const& each : candidates.parameters(m)) parameters.push_back(each.name);
    models.push_back({candidates.name(m), candidates.prior_probability(m), parameters});
  }
  return checkpoint::identity("abc_smc", settings, seed, std::move(models));
}

json store(State const& state, json const& identity, Ledger const& ledger) {
  json records = json::array(), departures = json::array();
  for (PopulationRecord const& each : state.records) records.push_back(store(each));
  for (State::Departure const& each : state.departures)
    departures.push_back({each.population, each.by_chance, store(each.particles)});
  return {{"identity", identity},
          {"last", store(state.last)},
          {"next", store(state.next)},
          {"record", store(state.record)},
          {"records", std::move(records)},
          {"departures", std::move(departures)},
          {"ledger", checkpoint::encode(ledger)}};
}

State restore(json const& stored, SelectionTarget const& candidates, Ledger& ledger) {
  State state;
  state.last = restore_population(stored.at("last"), candidates);
  state.next = restore_population(stored.at("next"), candidates);
  state.record = restore_record(stored.at("record"), candidates.size());
  for (json const& each : stored.at("records")) state.records.push_back(restore_record(each, candidates.size()));
  if (!in_order(state)) throw checkpoint::Mismatch("its populations do not follow each other");
  if (!state.records.empty() && !counted(state.last, state.records.back()))
    throw checkpoint::Mismatch("its particles are not those that were counted");
  for (int m = 0; m < candidates.size(); ++m) {
    json const& departure = stored.at("departures").at(static_cast<std::size_t>(m));
    state.departures.push_back(
        {departure.at(0).get<int>(), departure.at(1).get<bool>(), restore_particles(departure.at(2), candidates.dimension(m))});
    State::Departure const& last = state.departures.back();
    if (last.population < (last.by_chance ? 1 : 0) || last.population > state.last.number)
      throw checkpoint::Mismatch("a model died in a population that does not exist");
    if (last.population > 0 && state.last.models[static_cast<std::size_t>(m)].count() > 0)
      throw checkpoint::Mismatch("a model died and has particles");
  }
  ledger = checkpoint::decode_ledger(stored.at("ledger"));
  return state;
}

}  // namespace sysid::abc
