// One wavefront after another, an experiment at a time; a lane that is out after one takes no part in the next.
#include "likelihood/selection/model_selection_target.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/column_word.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/memory.hpp"
#include "likelihood/selection/drawn_simulation.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/thread_pool.hpp"
#include "simulate/wavefront.hpp"

namespace sysid {
namespace {

LaneArray gather(ConstLanes from, std::vector<int> const& lanes) {
  LaneArray result(from.rows(), static_cast<int>(lanes.size()));
  for (int r = 0; r < from.rows(); ++r)
    for (std::size_t w = 0; w < lanes.size(); ++w) result(r, static_cast<int>(w)) = from(r, lanes[w]);
  return result;
}

/// Expressions of the user's own, in the graph of the model as it is simulated.
DistanceMeasure drawn_measure(Model& drawn, Model const& model, DistanceMeasure measure) {
  for (std::optional<NodeId>& each : measure.expressions) {
    if (!each) continue;
    // The graph has grown by the numbers alone: nodes of before are where they were. What they read of disturbances is replaced.
    each = drawn.graph.substitute(*each, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& node = drawn.graph[leaf];
      if (node.leaf_kind != LeafKind::disturbance) return std::nullopt;
      NodeId const size =
          drawn.graph.unary(Operation::square_root, model.disturbances[static_cast<std::size_t>(node.index)].intensity);
      int const number = static_cast<int>(drawn.parameters.size() - model.disturbances.size()) + node.index;
      return drawn.graph.multiply(size, drawn.graph.leaf(LeafKind::parameter, number));
    });
  }
  return measure;
}

}  // namespace

/// The lanes of a batch that are still in, and what they have gathered.
struct ModelSelectionTarget::Running {
  std::vector<int> lanes;  // of the batch
  LaneArray sums;          // [channels x W], over the experiments so far
};

struct ModelSelectionTarget::Part {
  std::vector<Simulator> simulators;  // per experiment
  // Of a candidate with random states, whose sums are those of what is drawn:
  std::optional<DrawnSimulation> drawn;
  std::vector<Simulator> recorders;  // per experiment: the terms of the sums
  std::vector<std::unique_ptr<StartState>> starts;
  std::unique_ptr<Distance> distance;
};

ModelSelectionTarget::~ModelSelectionTarget() = default;

ModelSelectionTarget::ModelSelectionTarget(std::vector<SelectionCandidate> candidates)
    : candidates_(std::move(candidates)), pool_(make_pool(candidates_.front().options.execution)) {
  for (SelectionCandidate const& each : candidates_) {
    Part part;
    auto compiled = each.compiled;
    DistanceMeasure measure = each.measure;
    if (compiled->model.filtered()) {
      part.drawn = drawn_simulation(compiled->model);
      measure = drawn_measure(part.drawn->model, compiled->model, std::move(measure));
      compiled = compile(part.drawn->model, false, compiled->method);
    }
    auto const program = compile_distance(*compiled, measure);
    auto const terms = part.drawn ? compile_distance_terms(*compiled, measure) : nullptr;
    ExecutionOptions const& execution = candidates_.front().options.execution;
    for (Experiment const& experiment : each.experiments) {
      part.simulators.emplace_back(program, Schedule(*program, experiment, each.options.solver), execution, pool_);
      if (terms) part.recorders.emplace_back(terms, Schedule(*terms, experiment, each.options.solver), execution, pool_);
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
  auto const& drawn = parts_[static_cast<std::size_t>(model)].drawn;
  // Numbers that are drawn are 0 where nothing draws them.
  LaneArray parameters(drawn ? static_cast<int>(drawn->model.parameters.size()) : candidate.compiled->parameter_rows(),
                       theta.width());
  candidate.space->select(candidate.space->values(theta), experiment, parameters);
  auto const& starts = parts_[static_cast<std::size_t>(model)].starts;
  if (!starts.empty()) starts[static_cast<std::size_t>(experiment)]->estimate(parameters);
  return parameters;
}

void ModelSelectionTarget::simulate_drawn(int model, int experiment, ConstLanes theta, Lanes sums,
                                          std::span<Outcome> outcome) const {
  constexpr std::size_t most_numbers = std::size_t{1} << 22;
  Part const& part = parts_[static_cast<std::size_t>(model)];
  Simulator const& recorder = part.recorders[static_cast<std::size_t>(experiment)];
  Schedule const& summed = part.simulators[static_cast<std::size_t>(experiment)].schedule();
  Experiment const& record = at(model).experiments[static_cast<std::size_t>(experiment)];
  int const channels = sums.rows(), samples = summed.last_summed(), numbers = recorded_numbers(samples, channels);
  int const at_once = std::max(16, static_cast<int>(most_numbers / static_cast<std::size_t>(std::max(1, numbers))));
  LaneArray const parameters = simulation_parameters(model, experiment, theta);
  for (int begin = 0; begin < theta.width(); begin += at_once) {
    int const width = std::min(at_once, theta.width() - begin);
    LaneArray terms(numbers, width);
    // A lane's numbers are those of its parameters, whatever lanes lie beside it.
    auto const redraw = [&](int sample, int lane, Lanes all) {
      for (int w = 0; w < all.width(); ++w) {
        int const from = begin + lane + w;
        for (int p = 0; p < parameters.rows(); ++p) all(p, w) = parameters(p, from);
        StreamKey const key{1, Purpose::disturbance, word_of(theta, from), static_cast<std::uint64_t>(experiment) << 32};
        part.drawn->write(record, sample, key, all, w);
      }
    };
    recorder.records_redrawn(redraw, 0, samples, terms,
                             outcome.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(width)));
    for (int c = 0; c < channels; ++c)
      for (int i = 0; i < samples; ++i)
        if (summed.summed(c, i))
          for (int w = 0; w < width; ++w) sums(c, begin + w) += terms(i * channels + c, w);
  }
}

void ModelSelectionTarget::add_drawn(Batch const& batch, int experiment, double bound, Running& now) const {
  LaneArray const theta = gather(batch.theta, now.lanes);
  LaneArray sums(now.sums.rows(), theta.width());
  std::vector<Outcome> outcome(now.lanes.size());
  simulate_drawn(batch.model, experiment, theta, sums, outcome);
  std::vector<int> stay;
  for (std::size_t w = 0; w < now.lanes.size(); ++w) {
    int const lane = now.lanes[w];
    std::vector<double> total;
    for (int c = 0; c < sums.rows(); ++c) total.push_back(now.sums(c, lane) += sums(c, static_cast<int>(w)));
    bool const finite = outcome[w].ok && std::isfinite(distance(batch.model)(total));
    if (!finite) batch.ending[static_cast<std::size_t>(lane)] = Simulated::failed;
    // A distance grows with its sums.
    if (finite && distance(batch.model)(total) <= bound) stay.push_back(lane);
  }
  now.lanes = std::move(stay);
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
      if (part.drawn) {
        add_drawn(batches[b], static_cast<int>(e), bound, now);
        continue;
      }
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
