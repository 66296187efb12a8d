// Records of the trajectory program at the scored samples; noise widths by deviances, so that any distribution has one.
#include "likelihood/output.hpp"

#include <algorithm>
#include <cmath>

#include "core/system/memory.hpp"
#include "distribution/location_scale.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

/// Registers of records held at once.
constexpr std::size_t most_numbers = 1U << 23;  // 64 MiB

/// Of the noise as it is recorded, which is not the model's where moments stand for random states.
Kernel deviance_kernel(CompiledModel const& compiled, int channel) {
  DistributionRow const& noise = *compiled.noise[static_cast<std::size_t>(channel)];
  auto const arguments = std::ranges::count_if(compiled.records, [&](CompiledModel::Record const& each) {
    return each.kind == CompiledModel::Record::Kind::noise_argument && each.index == channel;
  });
  Graph graph = compiled.model.graph;
  std::vector<NodeId> leaves;
  for (int a = 0; a < static_cast<int>(arguments); ++a) leaves.push_back(graph.leaf(LeafKind::parameter, a));
  NodeId const x = graph.leaf(LeafKind::unknown, 0);
  NodeId const density = noise.log_density(graph, x, leaves);
  NodeId const gap = graph.subtract(noise.saturated(graph, x, leaves), density);
  leaves.push_back(x);
  NodeId const deviance[] = {graph.multiply(graph.constant(2), gap)};
  return compile_kernel(graph, leaves, deviance);
}

}  // namespace

Output::Output(std::shared_ptr<CompiledModel const> compiled, std::shared_ptr<ParameterSpace const> space,
               std::vector<Experiment> const& experiments, SolverSettings const& solver, int start_rows, ExecutionOptions options,
               std::shared_ptr<ThreadPool> pool)
    : compiled_(std::move(compiled)), space_(std::move(space)) {
  Model const& model = compiled_->model;
  if (compiled_->free_start) start_states_ = static_cast<int>(model.states.size());
  centre_row_.resize(model.channels.size());
  for (std::size_t r = 0; r < compiled_->records.size(); ++r)
    if (compiled_->records[r].kind == CompiledModel::Record::Kind::centre)
      centre_row_[static_cast<std::size_t>(compiled_->records[r].index)] = static_cast<int>(r);
  for (int c = 0; c < static_cast<int>(model.channels.size()); ++c) deviance_.push_back(deviance_kernel(*compiled_, c));
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    Experiment const& experiment = experiments[e];
    Schedule schedule(*compiled_->trajectory, with_corrections(model, experiment), solver);
    Part part{Simulator(compiled_->trajectory, std::move(schedule), options, pool), nullptr, 0, places_.size(), 0, false};
    if (start_rows > 0) part.start = std::make_shared<StartState const>(compiled_, experiment, start_rows, solver, options, pool);
    for (std::size_t c = 0; c < model.channels.size(); ++c)
      for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
        if (!experiment.is_scored(c, i)) continue;
        places_.push_back({static_cast<int>(e), static_cast<int>(c), static_cast<int>(i), experiment.measured[c][i]});
        part.samples = std::max(part.samples, static_cast<int>(i) + 1);
      }
    part.count = places_.size() - part.first;
    part.predicts = model.filtered() && !experiment.corrects.empty();
    parts_.push_back(std::move(part));
  }
}

LaneArray Output::parameters(ConstLanes points, int experiment) const {
  int const own = static_cast<int>(compiled_->model.parameters.size()), rows = static_cast<int>(space_->rows().size());
  LaneArray all(own + start_states_, points.width());
  ConstLanes const values(points.data(), rows, points.width(), points.stride());
  space_->select(values, experiment, Lanes(all.view().data(), own, points.width()));
  for (int s = 0; s < start_states_; ++s)
    for (int w = 0; w < points.width(); ++w) all(own + s, w) = points(rows + experiment * start_states_ + s, w);
  return all;
}

void Output::start(Lanes points) const {
  int const own = static_cast<int>(compiled_->model.parameters.size()), rows = static_cast<int>(space_->rows().size());
  for (int e = 0; e < static_cast<int>(parts_.size()) && start_states_ > 0; ++e) {
    LaneArray all = parameters(points, e);
    parts_[static_cast<std::size_t>(e)].start->estimate(all);
    for (int s = 0; s < start_states_; ++s)
      for (int w = 0; w < points.width(); ++w) points(rows + e * start_states_ + s, w) = all(own + s, w);
  }
}

LaneArray Output::records(ConstLanes points, int experiment, std::vector<Outcome>& outcome) const {
  Part const& part = parts_[static_cast<std::size_t>(experiment)];
  LaneArray out(recorded_numbers(part.samples, records_per_sample()), points.width());
  outcome.assign(static_cast<std::size_t>(points.width()), {});
  part.simulator.records(parameters(points, experiment), 0, part.samples, out, outcome);
  return out;
}

void Output::centres(ConstLanes points, Lanes out) const {
  std::vector<Outcome> outcome;
  for (int e = 0; e < static_cast<int>(parts_.size()); ++e) {
    Part const& part = parts_[static_cast<std::size_t>(e)];
    std::size_t const lane_size = static_cast<std::size_t>(std::max(1, recorded_numbers(part.samples, records_per_sample())));
    int const at_once = static_cast<int>(std::max<std::size_t>(16, most_numbers / lane_size));
    for (int first = 0; first < points.width(); first += at_once) {
      int const width = std::min(at_once, points.width() - first);
      LaneArray const all = records(points.columns(first, width), e, outcome);
      for (std::size_t r = part.first; r < part.first + part.count; ++r) {
        int const row = places_[r].sample * records_per_sample() + centre_row_[static_cast<std::size_t>(places_[r].channel)];
        for (int w = 0; w < width; ++w) out(static_cast<int>(r), first + w) = all(row, w);
      }
      if (part.predicts) add_spread(all, part, first, out);
    }
  }
}

void Output::add_spread(ConstLanes records, Part const& part, int first, Lanes out) const {
  for (std::size_t k = 0; k < compiled_->records.size(); ++k) {
    CompiledModel::Record const& spread = compiled_->records[k];
    if (spread.kind != CompiledModel::Record::Kind::spread) continue;
    for (int w = 0; w < records.width(); ++w) {
      Stream stream({0, Purpose::prediction, static_cast<std::uint64_t>(first + w), k});
      for (std::size_t r = part.first; r < part.first + part.count; ++r)
        if (centre_row_[static_cast<std::size_t>(places_[r].channel)] == spread.index)
          out(static_cast<int>(r), first + w) +=
              stream.normal() * records(places_[r].sample * records_per_sample() + static_cast<int>(k), w);
    }
  }
}

std::vector<double> Output::noise(ConstLanes point) const {
  std::vector<double> out(places_.size(), std::nan(""));
  std::vector<Outcome> outcome;
  for (int e = 0; e < static_cast<int>(parts_.size()); ++e) {
    LaneArray const all = records(point.columns(0, 1), e, outcome);
    if (!outcome.front().ok) continue;
    for (int c = 0; c < static_cast<int>(centre_row_.size()); ++c) add_noise(all, parts_[static_cast<std::size_t>(e)], c, out);
  }
  return out;
}

void Output::add_noise(LaneArray const& records, Part const& part, int channel, std::vector<double>& out) const {
  auto const c = static_cast<std::size_t>(channel);
  std::vector<std::size_t> mine;
  for (std::size_t r = part.first; r < part.first + part.count; ++r)
    if (places_[r].channel == channel) mine.push_back(r);
  if (mine.empty()) return;
  int const width = static_cast<int>(mine.size()), arguments = deviance_[c].inputs - 1;
  LaneArray below(arguments + 1, width), above(arguments + 1, width), low(1, width), high(1, width);
  std::vector<double> centre(mine.size()), step(mine.size());
  double size = 0;
  for (int w = 0; w < width; ++w) {
    int const row = places_[mine[static_cast<std::size_t>(w)]].sample * records_per_sample() + centre_row_[c];
    centre[static_cast<std::size_t>(w)] = records(row, 0);
    size = std::max(size, std::abs(records(row, 0)));
    for (int a = 0; a < arguments; ++a) below(a, w) = above(a, w) = records(row + 1 + a, 0);
  }
  for (std::size_t w = 0; w < mine.size(); ++w) step[w] = 1e-3 * (centre[w] != 0 ? std::abs(centre[w]) : size > 0 ? size : 1);
  for (int round = 0; round < 6; ++round) {
    for (int w = 0; w < width; ++w) {
      below(arguments, w) = centre[static_cast<std::size_t>(w)] - step[static_cast<std::size_t>(w)];
      above(arguments, w) = centre[static_cast<std::size_t>(w)] + step[static_cast<std::size_t>(w)];
    }
    run(deviance_[c], below, low);
    run(deviance_[c], above, high);
    for (int w = 0; w < width; ++w) {
      auto const i = static_cast<std::size_t>(w);
      double const a = low(0, w), b = high(0, w);
      // One side may lie outside the support.
      double const deviance = !std::isfinite(a) ? b : !std::isfinite(b) ? a : (a + b) / 2;
      if (!std::isfinite(deviance)) {
        step[i] /= 100;
      } else if (!(deviance > 1e-12)) {  // lost in rounding: the step is far below the noise
        step[i] *= 1e4;
      } else {
        double const width_there = step[i] / std::sqrt(deviance);
        out[mine[i]] = width_there;
        step[i] = 0.1 * width_there;
      }
    }
  }
}

std::vector<double> Output::state_sizes(ConstLanes point) const {
  std::vector<Outcome> outcome;
  std::size_t const states = compiled_->model.states.size();
  std::vector<double> sizes(parts_.size() * states, 0.0);
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    LaneArray const all = records(point.columns(0, 1), static_cast<int>(e), outcome);
    for (std::size_t r = 0; r < compiled_->records.size(); ++r) {
      if (compiled_->records[r].kind != CompiledModel::Record::Kind::state) continue;
      double square = 0;
      for (int i = 0; i < parts_[e].samples; ++i) {
        double const value = all(i * records_per_sample() + static_cast<int>(r), 0);
        square += value * value;
      }
      sizes[e * states + static_cast<std::size_t>(compiled_->records[r].index)] =
          std::sqrt(square / std::max(1, parts_[e].samples));
    }
  }
  return sizes;
}

std::vector<ParameterRole> parameter_roles(Model const& model) {
  Graph graph = model.graph;
  std::vector<NodeId> response = model.residuals, noise, prior, derived;
  response.insert(response.end(), model.memories.begin(), model.memories.end());
  std::vector<NodeId> const of_processes = sysid::read_by(model.processes);
  response.insert(response.end(), of_processes.begin(), of_processes.end());
  for (State const& state : model.states) {
    response.push_back(state.derivative);
    response.push_back(state.initial);
    if (state.initial_variance) noise.push_back(*state.initial_variance);
  }
  for (Disturbance const& disturbance : model.disturbances) noise.push_back(disturbance.intensity);
  for (Channel const& channel : model.channels) {
    response.push_back(channel.noise.row->centre(graph, channel.noise.arguments));
    noise.insert(noise.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  }
  for (Parameter const& parameter : model.parameters) {
    if (!parameter.prior) continue;
    prior.insert(prior.end(), parameter.prior->arguments.begin(), parameter.prior->arguments.end());
    if (parameter.prior->lower) prior.push_back(*parameter.prior->lower);
    if (parameter.prior->upper) prior.push_back(*parameter.prior->upper);
  }
  for (Derived const& each : model.derived) derived.push_back(each.value);
  std::vector<ParameterRole> roles;
  for (std::size_t p = 0; p < model.parameters.size(); ++p) {
    auto const read_by = [&](std::vector<NodeId> const& roots) {
      return std::any_of(roots.begin(), roots.end(), [&](NodeId root) {
        return graph.depends(root, [&](Node const& node) {
          return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter && node.index == static_cast<int>(p);
        });
      });
    };
    roles.push_back(read_by(response)  ? ParameterRole::response
                    : read_by(noise)   ? ParameterRole::noise
                    : read_by(prior)   ? ParameterRole::prior
                    : read_by(derived) ? ParameterRole::derived
                                       : ParameterRole::none);
  }
  return roles;
}

std::vector<bool> sizes_alone(Model const& model) {
  std::vector<ParameterRole> const roles = parameter_roles(model);
  std::vector<bool> sizes;
  for (std::size_t p = 0; p < roles.size(); ++p) {
    auto const scatters = [&](Parameter const& other) {
      auto const scale = other.prior ? scale_argument(*other.prior) : std::nullopt;
      return scale && model.graph.depends(*scale, [&](Node const& node) {
        return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter && node.index == static_cast<int>(p);
      });
    };
    sizes.push_back(roles[p] == ParameterRole::noise ||
                    (roles[p] == ParameterRole::prior && std::ranges::any_of(model.parameters, scatters)));
  }
  return sizes;
}

}  // namespace sysid
