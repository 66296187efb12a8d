// Channel sums as a program and as a number.
#include "likelihood/selection/distance.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

/// (y - y*)^2, y* the centre of the channel's noise.
NodeId squared_error(Graph& graph, Channel const& channel, int index) {
  NodeId const centre = channel.noise.row->centre(graph, channel.noise.arguments);
  NodeId const error = graph.subtract(graph.leaf(LeafKind::measured, index), centre);
  return graph.multiply(error, error);
}

/// N var y of the samples of a channel that are summed.
double spread_about_mean(Schedule const& schedule, int channel) {
  std::vector<double> const& y = schedule.experiment().measured[static_cast<std::size_t>(channel)];
  double sum = 0, squares = 0;
  for (int i = 0; i < schedule.samples(); ++i)
    if (schedule.summed(channel, i)) sum += y[static_cast<std::size_t>(i)];
  double const mean = sum / std::max(1, schedule.count(channel));
  for (int i = 0; i < schedule.samples(); ++i) {
    double const deviation = y[static_cast<std::size_t>(i)] - mean;
    if (schedule.summed(channel, i)) squares += deviation * deviation;
  }
  return squares;
}

/// Of each channel, in a graph that has grown.
std::vector<NodeId> terms(Graph& graph, Model const& model, DistanceMeasure const& measure) {
  std::vector<NodeId> sums;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    if (measure.weights[c] == 0)
      sums.push_back(graph.constant(0));
    else
      sums.push_back(measure.kind == DistanceKind::mean ? *measure.expressions[c]
                                                        : squared_error(graph, model.channels[c], static_cast<int>(c)));
  }
  return sums;
}

}  // namespace

std::shared_ptr<SimulationProgram const> compile_distance(CompiledModel const& compiled, DistanceMeasure const& measure) {
  Graph graph = compiled.model.graph;
  std::vector<NodeId> const sums = terms(graph, compiled.model, measure);
  return compile_sums(compiled, std::move(graph), sums);
}

std::shared_ptr<SimulationProgram const> compile_distance_terms(CompiledModel const& compiled, DistanceMeasure const& measure) {
  Graph graph = compiled.model.graph;
  std::vector<NodeId> const sums = terms(graph, compiled.model, measure);
  return compile_records(compiled, std::move(graph), sums);
}

Distance::Distance(Model const& model, DistanceMeasure const& measure, std::span<Schedule const* const> experiments)
    : kind_(measure.kind) {
  double total = 0;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    int const channel = static_cast<int>(c);
    int count = 0;
    double spread = 0;
    for (Schedule const* schedule : experiments) {
      if (schedule->count(channel) == 0) continue;
      count += schedule->count(channel);
      spread += spread_about_mean(*schedule, channel);
    }
    double const weight = count > 0 ? measure.weights[c] : 0;
    if (kind_ == DistanceKind::nmse && weight > 0 && !(spread > 0))
      throw UserError(
          {Severity::error,
           "E6517",
           fmt::format("channel `{}` does not vary in the scored rows, so its NMSE is not defined", model.channels[c].name),
           std::nullopt,
           {},
           "score rows in which it moves, or take `distance = rmse`"});
    weight_.push_back(weight);
    count_.push_back(count);
    scale_.push_back(weight == 0                   ? 0
                     : kind_ == DistanceKind::nmse ? 100 / spread
                     : kind_ == DistanceKind::rmse ? 1 / (count * measure.unit * measure.unit)
                                                   : 1.0 / count);
    total += weight;
  }
  for (double& weight : weight_) weight /= total;
}

double Distance::operator()(std::span<double const> sums) const {
  double distance = 0;
  for (std::size_t c = 0; c < weight_.size(); ++c) {
    if (weight_[c] == 0) continue;
    double const scaled = scale_[c] * sums[c];
    distance += weight_[c] * (kind_ == DistanceKind::rmse ? std::sqrt(scaled) : scaled);
  }
  return distance;
}

double Distance::floor(std::span<double const> sd) const {
  if (kind_ == DistanceKind::mean) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sums;
  for (std::size_t c = 0; c < weight_.size(); ++c) sums.push_back(count_[c] * sd[c] * sd[c]);
  return (*this)(sums);
}

}  // namespace sysid
