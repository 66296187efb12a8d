// Segments of two rows, each begun on the simulated motion.
#include "discovery/search/sample_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "likelihood/segments/segment_differences.hpp"

namespace sysid {
namespace {

constexpr double input_step = 1e-4;  // of an input's root mean square

/// The simulated states at all rows; empty where one is not known.
std::vector<std::vector<Eigen::VectorXd>> simulated_states(WholeDictionary const& dictionary, FittedTerms const& fitted,
                                                           FitConditions const& conditions,
                                                           std::vector<std::size_t> const& channels) {
  FitConditions alike = conditions;
  alike.noise = {};
  std::vector<SegmentSlopes> const runs = dictionary.residuals(fitted, alike);
  std::vector<Segment> const parts = dictionary.segments(conditions.halved);
  std::vector<Experiment> const& records = dictionary.records();
  std::vector<std::vector<Eigen::VectorXd>> states;
  for (Experiment const& each : records)
    states.emplace_back(each.time.size(), Eigen::VectorXd(static_cast<Eigen::Index>(channels.size())));
  for (std::size_t s = 0; s < parts.size(); ++s) {
    auto const e = static_cast<std::size_t>(parts[s].experiment);
    for (std::size_t x = 0; x < channels.size(); ++x)
      for (int i = 0; i < parts[s].count; ++i) {
        auto const row = static_cast<std::size_t>(parts[s].first + i);
        double const value = records[e].measured[channels[x]].empty()
                                 ? std::nan("")
                                 : records[e].measured[channels[x]][row] +
                                       runs[s].residual(static_cast<Eigen::Index>(channels[x]) * parts[s].count + i);
        if (!std::isfinite(value) || records[e].scored[row] == 0) return {};
        states[e][row](static_cast<Eigen::Index>(x)) = value;
      }
  }
  return states;
}

/// Each pair of neighbouring rows.
std::vector<Segment> pairs_of(std::vector<Experiment> const& records) {
  std::vector<Segment> pairs;
  for (std::size_t e = 0; e < records.size(); ++e)
    for (int n = 0; n + 1 < static_cast<int>(records[e].time.size()); ++n) pairs.push_back({static_cast<int>(e), n, 2});
  return pairs;
}

/// Input i moved by a step in every other row.
std::vector<Experiment> moved_inputs(std::vector<Experiment> records, std::size_t input, int parity, double step) {
  for (Experiment& each : records) {
    std::vector<double> samples;
    for (int row = 0; row < each.inputs[input].rows(); ++row)
      samples.push_back(each.inputs[input].sample(row) + (row % 2 == parity ? step : 0));
    each.inputs[input] = InputSignal(each.inputs[input].rule(), each.time, std::move(samples));
  }
  return records;
}

double size_of_input(std::vector<Experiment> const& records, std::size_t input) {
  double squares = 0, count = 0;
  for (Experiment const& each : records)
    for (int row = 0; row < each.inputs[input].rows(); ++row) squares += std::pow(each.inputs[input].sample(row), 2), ++count;
  return squares > 0 ? std::sqrt(squares / count) : 1;
}

}  // namespace

std::optional<std::vector<std::size_t>> channels_of_states(WholeDictionary const& dictionary) {
  std::vector<std::size_t> out;
  for (std::pair<int, int> const& state : dictionary.model().states) {
    std::optional<std::size_t> const channel = dictionary.channel_of(state);
    if (!channel) return std::nullopt;
    out.push_back(*channel);
  }
  return out;
}

std::optional<std::vector<SampleSteps>> sample_steps(WholeDictionary const& dictionary, FittedTerms const& fitted,
                                                     FitConditions const& conditions, bool inputs) {
  auto const channels = channels_of_states(dictionary);
  if (!channels) return std::nullopt;
  std::vector<Experiment> const& records = dictionary.records();
  auto states = simulated_states(dictionary, fitted, conditions, *channels);
  if (states.empty()) return std::nullopt;
  std::vector<Segment> const pairs = pairs_of(records);
  auto const d = static_cast<Eigen::Index>(channels->size());
  ShootingPoint point{Eigen::VectorXd(), Eigen::MatrixXd(d, static_cast<Eigen::Index>(pairs.size()))};
  for (std::size_t p = 0; p < pairs.size(); ++p)
    point.starts.col(static_cast<Eigen::Index>(p)) =
        states[static_cast<std::size_t>(pairs[p].experiment)][static_cast<std::size_t>(pairs[p].first)];
  auto const end_of = [&](std::size_t x) { return static_cast<Eigen::Index>((*channels)[x]) * 2 + 1; };  // row of a pair's second
  FitConditions alike = conditions;
  alike.noise = {};
  SegmentSimulation const simulation = dictionary.simulation(fitted, pairs, alike, records);
  std::vector<SegmentSlopes> const slopes = SegmentDifferences(simulation, point).at(point, most_probes);
  std::size_t const count = inputs ? dictionary.model().inputs.size() : 0;
  std::vector<SampleSteps> out;
  for (auto& each : states) out.push_back({std::move(each), {}, {}, {}});
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    SampleSteps& of = out[static_cast<std::size_t>(pairs[p].experiment)];
    Eigen::MatrixXd ahead(d, d);
    for (std::size_t x = 0; x < channels->size(); ++x) ahead.row(static_cast<Eigen::Index>(x)) = slopes[p].by_start.row(end_of(x));
    if (!ahead.allFinite()) return std::nullopt;
    of.ahead.push_back(std::move(ahead));
    of.here.emplace_back(Eigen::MatrixXd::Zero(d, static_cast<Eigen::Index>(count)));
    of.next.emplace_back(Eigen::MatrixXd::Zero(d, static_cast<Eigen::Index>(count)));
  }
  for (std::size_t i = 0; i < count; ++i)
    for (int parity = 0; parity < 2; ++parity) {
      double const step = input_step * size_of_input(records, i);
      std::vector<SegmentSlopes> const moved =
          dictionary.simulation(fitted, pairs, alike, moved_inputs(records, i, parity, step)).residuals(point);
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        SampleSteps& of = out[static_cast<std::size_t>(pairs[p].experiment)];
        auto const n = static_cast<std::size_t>(pairs[p].first);
        Eigen::MatrixXd& by = pairs[p].first % 2 == parity ? of.here[n] : of.next[n];
        for (std::size_t x = 0; x < channels->size(); ++x)
          by(static_cast<Eigen::Index>(x), static_cast<Eigen::Index>(i)) =
              (moved[p].residual(end_of(x)) - slopes[p].residual(end_of(x))) / step;
      }
    }
  return out;
}

}  // namespace sysid
