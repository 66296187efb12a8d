// Moments with what they have to do with the last sample, recorded before and after each sample.
#include "likelihood/smoothing/smoothing_program.hpp"

#include <span>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "likelihood/model_source.hpp"

namespace sysid {
namespace {

class Records {
 public:
  explicit Records(SimulationSource& source, Graph const& graph) : source_(source), graph_(graph) {}

  /// Records of what may differ from 0.
  std::vector<int> of(std::span<NodeId const> values, int when) {
    std::vector<int> places;
    for (NodeId const value : values) {
      bool const zero = graph_.is_constant(value, 0);
      places.push_back(zero ? -1 : static_cast<int>(source_.records.size()));
      if (zero) continue;
      source_.records.push_back(value);
      source_.recorded_at.push_back(when);
    }
    return places;
  }

 private:
  SimulationSource& source_;
  Graph const& graph_;
};

SmoothingRecords add_records(SimulationSource& source, Moments const& moments, Graph& graph) {
  SmoothingRecords layout;
  Records records(source, graph);
  std::vector<NodeId> means;
  for (std::size_t i = 0; i < moments.means; ++i) means.push_back(graph.leaf(LeafKind::state, static_cast<int>(i)));
  SincePastSample const& since = *moments.since;
  layout.states = static_cast<int>(moments.means);
  layout.noises = static_cast<int>(since.sums.size());
  layout.mean_before = records.of(means, before_channels);
  layout.covariance_before = records.of(moments.covariance, before_channels);
  layout.past = records.of(since.states, before_channels);
  layout.noise = records.of(since.noises, before_channels);
  layout.sum = records.of(since.sums, before_channels);
  layout.mean_after = records.of(means, after_channels);
  layout.covariance_after = records.of(moments.covariance, after_channels);
  layout.count = static_cast<int>(source.records.size());
  return layout;
}

bool reads_states(Graph const& graph, NodeId id) {
  return graph.depends(id, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; });
}

void choose_shown(SmoothingProgram& smoothing, Graph const& graph) {
  using Kind = SmoothedKind::Kind;
  Model const& model = smoothing.compiled->model;
  if (model.dynamics != Dynamics::discrete)
    for (std::size_t s = 0; s < model.states.size(); ++s) smoothing.shown.push_back({Kind::state, static_cast<int>(s)});
  for (std::size_t d = 0; d < model.disturbances.size(); ++d) {
    int const state = model.disturbances[d].state;
    if (state < 0)
      smoothing.shown.push_back({Kind::average, static_cast<int>(d)});
    else if (model.dynamics == Dynamics::discrete)
      smoothing.shown.push_back({Kind::state, state});
  }
  for (std::size_t d = 0; d < model.derived.size(); ++d)
    if (model.derived[d].per_sample && reads_states(graph, model.derived[d].value))
      smoothing.shown.push_back({Kind::derived, static_cast<int>(d)});
}

void compile_derived(SmoothingProgram& smoothing, Folded& folded) {
  Graph& graph = folded.graph;
  std::vector<NodeId> inputs, outputs;
  for (int p = 0; p < smoothing.compiled->parameter_rows(); ++p) inputs.push_back(graph.leaf(LeafKind::parameter, p));
  auto const first_state = static_cast<std::ptrdiff_t>(inputs.size());
  for (int s = 0; s < smoothing.layout.states; ++s) inputs.push_back(graph.leaf(LeafKind::state, s));
  std::vector<NodeId> const states(inputs.begin() + first_state, inputs.end());
  for (SmoothedKind const& each : smoothing.shown) {
    if (each.kind != SmoothedKind::Kind::derived) continue;
    NodeId const value = folded(smoothing.compiled->model.derived[static_cast<std::size_t>(each.index)].value);
    outputs.push_back(value);
    for (NodeId const state : states) outputs.push_back(finite_slope(graph, value, state));
  }
  for (NodeId const id : graph.reachable(outputs)) {
    Node const& node = graph[id];
    if (node.operation != Operation::leaf || node.leaf_kind == LeafKind::parameter || node.leaf_kind == LeafKind::state) continue;
    inputs.push_back(id);
    smoothing.leaves.push_back({node.leaf_kind, node.index, node.stage, node.lag});
  }
  smoothing.derived = compile_kernel(graph, inputs, outputs);
}

}  // namespace

std::shared_ptr<SmoothingProgram const> compile_smoothing(std::shared_ptr<CompiledModel const> compiled) {
  if (!compiled->model.filtered()) throw InternalError("smoothing of states that are known");
  auto smoothing = std::make_shared<SmoothingProgram>();
  smoothing->compiled = std::move(compiled);
  Folded folded(smoothing->compiled->model, keeps_unknowns(*smoothing->compiled));
  ModelSource const of = source_of(folded, *smoothing->compiled, true);
  SimulationSource source = of.dynamics;
  for (std::size_t c = 0; c < smoothing->compiled->model.channels.size(); ++c) source.channels.push_back(of.channel(c, {}));
  source.channels.push_back({{}, of.moments->since->begin, true});
  smoothing->layout = add_records(source, *of.moments, folded.graph);
  source.graph = folded.graph;
  smoothing->program = std::make_shared<SimulationProgram const>(compile(std::move(source)));
  choose_shown(*smoothing, smoothing->compiled->model.graph);
  compile_derived(*smoothing, folded);
  return smoothing;
}

}  // namespace sysid
