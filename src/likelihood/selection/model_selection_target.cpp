// One wavefront after another, an experiment at a time; a lane that is out after one takes no part in the next.
#include "likelihood/selection/model_selection_target.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/thread_pool.hpp"
#include "simulate/wavefront.hpp"

namespace sysid {
namespace {

/// The lanes of a batch that are still in, and what they have gathered.
struct Running {
  std::vector<int> lanes;  // of the batch
  LaneArray sums;          // [channels x W], over the experiments so far
};

LaneArray gather(ConstLanes from, std::vector<int> const& lanes) {
  LaneArray result(from.rows(), static_cast<int>(lanes.size()));
  for (int r = 0; r < from.rows(); ++r)
    for (std::size_t w = 0; w < lanes.size(); ++w) result(r, static_cast<int>(w)) = from(r, lanes[w]);
  return result;
}

}  // namespace

struct ModelSelectionTarget::Part {
  std::vector<Simulator> simulators;  // per experiment
  std::vector<std::unique_ptr<StartState>> starts;
  std::unique_ptr<Distance> distance;
};

ModelSelectionTarget::~ModelSelectionTarget() = default;

ModelSelectionTarget::ModelSelectionTarget(std::vector<SelectionCandidate> candidates)
    : candidates_(std::move(candidates)), pool_(make_pool(candidates_.front().options.execution)) {
  for (SelectionCandidate const& each : candidates_) {
    Part part;
    auto const program = compile_distance(*each.compiled, each.measure);
    ExecutionOptions const& execution = candidates_.front().options.execution;
    for (Experiment const& experiment : each.experiments) {
      part.simulators.emplace_back(program, Schedule(*program, experiment, each.options.solver), execution, pool_);
      if (each.options.start_rows > 0)
        part.starts.push_back(std::make_unique<StartState>(each.compiled, experiment, each.options.start_rows, each.options.solver,
                                                           execution, pool_));
    }
    std::vector<Schedule const*> schedules;
    for (Simulator const& simulator : part.simulators) schedules.push_back(&simulator.schedule());
    part.distance = std::make_unique<Distance>(each.compiled->model, each.measure, schedules);
    parts_.push_back(std::move(part));
  }
}

Distance const& ModelSelectionTarget::distance(int model) const { return *parts_[static_cast<std::size_t>(model)].distance; }

LaneArray ModelSelectionTarget::simulation_parameters(int model, int experiment, ConstLanes theta) const {
  SelectionCandidate const& candidate = at(model);
  LaneArray parameters(candidate.compiled->parameter_rows(), theta.width());
  candidate.space->select(candidate.space->values(theta), experiment, parameters);
  auto const& starts = parts_[static_cast<std::size_t>(model)].starts;
  if (!starts.empty()) starts[static_cast<std::size_t>(experiment)]->estimate(parameters);
  return parameters;
}

void ModelSelectionTarget::distances(std::span<Batch const> batches, double bound) const {
  std::vector<Running> running(batches.size());
  std::size_t rounds = 0;
  for (std::size_t b = 0; b < batches.size(); ++b) {
    Batch const& batch = batches[b];
    rounds = std::max(rounds, at(batch.model).experiments.size());
    std::fill(batch.distance.begin(), batch.distance.end(), infinity);
    std::fill(batch.ending.begin(), batch.ending.end(), Simulated::beyond);
    for (int w = 0; w < batch.theta.width(); ++w) running[b].lanes.push_back(w);
    running[b].sums = LaneArray(static_cast<int>(at(batch.model).compiled->model.channels.size()), batch.theta.width());
  }
  for (std::size_t e = 0; e < rounds; ++e) {
    std::vector<LaneArray> parameters(batches.size()), sums(batches.size());
    std::vector<std::vector<Ending>> endings(batches.size());
    std::vector<std::vector<int>> failed_at(batches.size());
    std::vector<Work> work;
    for (std::size_t b = 0; b < batches.size(); ++b) {
      Running& now = running[b];
      int const model = batches[b].model;
      Part const& part = parts_[static_cast<std::size_t>(model)];
      if (e >= part.simulators.size() || now.lanes.empty()) continue;
      parameters[b] = simulation_parameters(model, static_cast<int>(e), gather(batches[b].theta, now.lanes));
      sums[b] = LaneArray(now.sums.rows(), static_cast<int>(now.lanes.size()));
      endings[b].assign(now.lanes.size(), Ending::finished);
      failed_at[b].assign(now.lanes.size(), -1);
      Wanted const wanted = [&now, &part, bound](ConstLanes partial, int column, int lane) {
        double all[64];
        std::vector<double> many;
        int const channels = partial.rows();
        double* const total = channels <= 64 ? all : (many.resize(static_cast<std::size_t>(channels)), many.data());
        for (int c = 0; c < channels; ++c) total[c] = now.sums(c, now.lanes[static_cast<std::size_t>(lane)]) + partial(c, column);
        return (*part.distance)({total, static_cast<std::size_t>(channels)}) <= bound;
      };
      work.push_back(wavefront_work(part.simulators[e], parameters[b], wanted, sums[b], endings[b], failed_at[b]));
    }
    do_work(work, pool_.get());
    for (std::size_t b = 0; b < batches.size(); ++b) {
      if (endings[b].empty()) continue;
      Running& now = running[b];
      std::vector<int> stay;
      for (std::size_t w = 0; w < now.lanes.size(); ++w) {
        int const lane = now.lanes[w];
        if (endings[b][w] == Ending::failed) batches[b].ending[static_cast<std::size_t>(lane)] = Simulated::failed;
        if (endings[b][w] != Ending::finished) continue;
        for (int c = 0; c < now.sums.rows(); ++c) now.sums(c, lane) += sums[b](c, static_cast<int>(w));
        stay.push_back(lane);
      }
      now.lanes = std::move(stay);
    }
  }
  for (std::size_t b = 0; b < batches.size(); ++b) {
    Distance const& distance = this->distance(batches[b].model);
    for (int const lane : running[b].lanes) {
      std::vector<double> sums;
      for (int c = 0; c < running[b].sums.rows(); ++c) sums.push_back(running[b].sums(c, lane));
      double const far = distance(sums);
      // Sums may be finite and what is made of them not.
      batches[b].distance[static_cast<std::size_t>(lane)] = std::isfinite(far) ? far : infinity;
      batches[b].ending[static_cast<std::size_t>(lane)] = std::isfinite(far) ? Simulated::within : Simulated::failed;
    }
  }
}

std::pair<std::string, double> ModelSelectionTarget::failure(int model, ConstLanes theta) const {
  SelectionCandidate const& candidate = at(model);
  Part const& part = parts_[static_cast<std::size_t>(model)];
  for (std::size_t e = 0; e < part.simulators.size(); ++e) {
    LaneArray const parameters = simulation_parameters(model, static_cast<int>(e), theta);
    std::vector<double> column;
    for (int p = 0; p < parameters.rows(); ++p) column.push_back(parameters(p, 0));
    Simulator const& simulator = part.simulators[e];
    if (auto const found = simulator.diagnose(column)) {
      Graph const& graph = simulator.program().source.graph;
      return {candidate.options.describe ? candidate.options.describe(found->node, graph) : "the model", found->time};
    }
  }
  return {"a sum over the samples", 0};
}

void ModelSelectionTarget::parallel(int tasks, std::function<void(int)> const& task) const {
  if (pool_) return pool_->run(tasks, task);
  for (int t = 0; t < tasks; ++t) task(t);
}

}  // namespace sysid
