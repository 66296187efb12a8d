// Segments of two rows, each begun on the simulated motion.
#include "discovery/search/sample_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "likelihood/segments/segment_differences.hpp"

namespace sysid {
namespace {

constexpr double input_step = 1e-4;  // of an input's root mean square

/// Records whose columns are the states of the model: 0 in all rows.
std::vector<Experiment> with_columns_of_states(WholeDictionary const& dictionary) {
  std::vector<Experiment> records = dictionary.records();
  for (Experiment& each : records) {
    each.measured.assign(dictionary.model().states.size(), std::vector<double>(each.time.size(), 0));
    each.scored.assign(each.time.size(), 1);
  }
  return records;
}

/// Puts the simulated states into these columns. Whether all are finite.
bool fill_with_states(WholeDictionary const& dictionary, FittedTerms const& fitted, FitConditions const& conditions,
                      std::vector<Experiment>& records) {
  std::vector<Segment> const parts = dictionary.segments(conditions.halved);
  std::vector<SegmentSlopes> const runs =
      dictionary.states(fitted, parts, conditions, records).residuals({Eigen::VectorXd(), fitted.fit.point.starts});
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (!runs[s].finite()) return false;
    Experiment& of = records[static_cast<std::size_t>(parts[s].experiment)];
    Eigen::Index row = 0;
    for (std::vector<double>& column : of.measured)
      for (int i = 0; i < parts[s].count; ++i) column[static_cast<std::size_t>(parts[s].first + i)] = runs[s].residual(row++);
  }
  return true;
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

std::optional<std::vector<SampleSteps>> sample_steps(WholeDictionary const& dictionary, FittedTerms const& fitted,
                                                     FitConditions const& conditions, bool inputs) {
  std::vector<Experiment> records = with_columns_of_states(dictionary);
  if (!fill_with_states(dictionary, fitted, conditions, records)) return std::nullopt;
  std::vector<Segment> const pairs = pairs_of(records);
  auto const d = static_cast<Eigen::Index>(dictionary.model().states.size());
  auto const states_at = [&](Experiment const& record, std::size_t row) {
    Eigen::VectorXd states(d);
    for (Eigen::Index x = 0; x < d; ++x) states(x) = record.measured[static_cast<std::size_t>(x)][row];
    return states;
  };
  ShootingPoint point{Eigen::VectorXd(), Eigen::MatrixXd(d, static_cast<Eigen::Index>(pairs.size()))};
  for (std::size_t p = 0; p < pairs.size(); ++p)
    point.starts.col(static_cast<Eigen::Index>(p)) =
        states_at(records[static_cast<std::size_t>(pairs[p].experiment)], static_cast<std::size_t>(pairs[p].first));
  auto const end_of = [](Eigen::Index x) { return x * 2 + 1; };  // row of a pair's second
  SegmentSimulation const simulation = dictionary.states(fitted, pairs, conditions, records);
  std::vector<SegmentSlopes> const slopes = SegmentDifferences(simulation, point).at(point, most_probes);
  std::size_t const count = inputs ? dictionary.model().inputs.size() : 0;
  std::vector<SampleSteps> out;
  for (Experiment const& each : records) {
    SampleSteps& of = out.emplace_back();
    for (std::size_t row = 0; row < each.time.size(); ++row) of.states.push_back(states_at(each, row));
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    SampleSteps& of = out[static_cast<std::size_t>(pairs[p].experiment)];
    Eigen::MatrixXd ahead(d, d);
    for (Eigen::Index x = 0; x < d; ++x) ahead.row(x) = slopes[p].by_start.row(end_of(x));
    if (!ahead.allFinite()) return std::nullopt;
    of.ahead.push_back(std::move(ahead));
    of.here.emplace_back(Eigen::MatrixXd::Zero(d, static_cast<Eigen::Index>(count)));
    of.next.emplace_back(Eigen::MatrixXd::Zero(d, static_cast<Eigen::Index>(count)));
  }
  for (std::size_t i = 0; i < count; ++i)
    for (int parity = 0; parity < 2; ++parity) {
      double const step = input_step * size_of_input(records, i);
      std::vector<SegmentSlopes> const moved =
          dictionary.states(fitted, pairs, conditions, moved_inputs(records, i, parity, step)).residuals(point);
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        SampleSteps& of = out[static_cast<std::size_t>(pairs[p].experiment)];
        auto const n = static_cast<std::size_t>(pairs[p].first);
        Eigen::MatrixXd& by = pairs[p].first % 2 == parity ? of.here[n] : of.next[n];
        for (Eigen::Index x = 0; x < d; ++x)
          by(x, static_cast<Eigen::Index>(i)) = (moved[p].residual(end_of(x)) - slopes[p].residual(end_of(x))) / step;
      }
    }
  return out;
}

}  // namespace sysid
