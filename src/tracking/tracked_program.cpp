// Parameters take their places as states; transitions are states that every sample sets back to the identity.
#include "tracking/tracked_program.hpp"

#include <utility>

#include "distribution/distribution.hpp"
#include "expression/finite_slope.hpp"

namespace sysid {
namespace {

class TrackingWriter {
 public:
  TrackingWriter(Model const& model, std::span<double const> values, std::span<TrackedParameter const> tracked)
      : model_(model), values_(values), tracked_(tracked), graph_(model.graph) {
    result_.states = static_cast<int>(model.states.size());
    result_.tracked = static_cast<int>(tracked.size());
    for (int j = 0; j < result_.tracked; ++j) {
      Coordinate const coordinate = moved(j, graph_.leaf(LeafKind::state, result_.states + j));
      parameter_values_.push_back(coordinate.value);
    }
  }

  TrackedProgram write(std::string const& method, MomentRule rule) {
    compile_values();
    write_dynamics(method);
    Moments moments = with_moments(std::move(source_), random_, channels_, rule);
    graph_ = moments.source.graph;
    source_ = std::move(moments.source);
    result_.moments = static_cast<int>(source_.derivative.size());
    for (int i = 0; i < result_.size(); ++i)
      for (int j = 0; j < result_.size(); ++j) {
        Node const& node = graph_[moments.of(i, j)];
        result_.covariance.push_back(node.operation == Operation::leaf ? node.index : -1);
      }
    source_.initial.clear();
    int const before = result_.tracked + static_cast<int>(channels_.size());
    source_.parameters = before + result_.moments;
    for (int m = 0; m < result_.moments; ++m) source_.initial.push_back(graph_.leaf(LeafKind::parameter, before + m));
    add_transition();
    add_channels(moments.channels);
    add_records(moments.channels);
    source_.graph = graph_;
    result_.program = std::make_shared<SimulationProgram const>(compile(std::move(source_)));
    return std::move(result_);
  }

 private:
  Support bounds(Graph& graph, int j) const {
    TrackedParameter const& each = tracked_[static_cast<std::size_t>(j)];
    Support support;
    if (each.lower) support.lower = graph.constant(*each.lower);
    if (each.upper) support.upper = graph.constant(*each.upper);
    support.logarithmic = each.logarithmic;
    return support;
  }
  Coordinate moved(int j, NodeId coordinate) { return constrain(graph_, bounds(graph_, j), coordinate); }

  void compile_values() {
    std::vector<NodeId> leaves, outputs, slopes;
    for (int j = 0; j < result_.tracked; ++j) {
      leaves.push_back(graph_.leaf(LeafKind::unconstrained, j));
      Coordinate const coordinate = moved(j, leaves.back());
      outputs.push_back(coordinate.value);
      slopes.push_back(graph_.differentiate(coordinate.value, leaves.back()));
    }
    outputs.insert(outputs.end(), slopes.begin(), slopes.end());
    result_.values = compile_kernel(graph_, leaves, outputs);
  }

  /// With numbers in place of the parameters that are not tracked.
  NodeId put(NodeId root) {
    return graph_.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = graph_[leaf];
      if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
      for (std::size_t j = 0; j < tracked_.size(); ++j)
        if (tracked_[j].parameter == node.index) return parameter_values_[j];
      return graph_.constant(values_[static_cast<std::size_t>(node.index)]);
    });
  }

  void write_dynamics(std::string const& method) {
    SimulationSource& source = source_;
    source.integrator = method;
    source.map = !model_.integrated();
    source.parameters = result_.tracked + static_cast<int>(model_.channels.size());
    source.inputs = static_cast<int>(model_.inputs.size());
    for (State const& state : model_.states) source.derivative.push_back(put(state.derivative));
    for (int j = 0; j < result_.tracked; ++j) {
      NodeId const noise = graph_.leaf(LeafKind::disturbance, static_cast<int>(model_.disturbances.size()) + j);
      source.derivative.push_back(source.map ? graph_.add(graph_.leaf(LeafKind::state, result_.states + j), noise) : noise);
    }
    source.initial.assign(source.derivative.size(), graph_.constant(0));
    for (Channel const& channel : model_.channels) {
      NodeId const sd = put(channel.noise.arguments[1]);
      NodeId const factor = graph_.leaf(LeafKind::parameter, result_.tracked + static_cast<int>(channels_.size()));
      channels_.push_back({put(channel.noise.arguments[0]), graph_.multiply(graph_.multiply(sd, sd), factor)});
    }
    for (Disturbance const& each : model_.disturbances) random_.noises.push_back({put(each.intensity), each.held});
    for (int j = 0; j < result_.tracked; ++j) random_.noises.push_back({graph_.leaf(LeafKind::parameter, j), false});
    random_.first_column = result_.states;
    random_.initial_variances.assign(static_cast<std::size_t>(result_.size()), graph_.constant(1));  // there is one
    source.graph = graph_;
  }

  NodeId transition(int i, int k) {
    if (i >= result_.states) return graph_.constant(i == k ? 1 : 0);
    return graph_.leaf(LeafKind::state, result_.moments + i * result_.size() + k);
  }

  /// F' = A F between samples, and of a map F <- A F, from the identity.
  void add_transition() {
    NodeId const zero = graph_.constant(0);
    for (int i = 0; i < result_.states; ++i) {
      NodeId const rule = source_.derivative[static_cast<std::size_t>(i)];  // of the mean, as the filter moves it
      std::vector<NodeId> slopes;
      for (int l = 0; l < result_.size(); ++l) slopes.push_back(finite_slope(graph_, rule, graph_.leaf(LeafKind::state, l)));
      for (int k = 0; k < result_.size(); ++k) {
        NodeId sum = zero;
        for (int l = 0; l < result_.size(); ++l) {
          NodeId const with = transition(l, k);
          if (!graph_.is_constant(with, 0) && !graph_.is_constant(slopes[static_cast<std::size_t>(l)], 0))
            sum = graph_.add(sum, graph_.multiply(slopes[static_cast<std::size_t>(l)], with));
        }
        source_.derivative.push_back(sum);
        source_.initial.push_back(graph_.constant(i == k ? 1 : 0));
      }
    }
  }

  void add_channels(std::vector<Innovation> const& innovations) {
    std::vector<NodeId> same;
    for (int m = 0; m < static_cast<int>(source_.derivative.size()); ++m) same.push_back(graph_.leaf(LeafKind::state, m));
    for (Innovation const& each : innovations) {
      std::vector<NodeId> correct = each.correct;
      correct.insert(correct.end(), same.begin() + result_.moments, same.end());
      source_.channels.push_back({{}, std::move(correct), false});
    }
    // One that comes last, and at every sample, sets the transition back.
    std::vector<NodeId> back(same.begin(), same.begin() + result_.moments);
    for (int i = 0; i < result_.states; ++i)
      for (int k = 0; k < result_.size(); ++k) back.push_back(graph_.constant(i == k ? 1 : 0));
    source_.channels.push_back({{}, std::move(back), true});
  }

  int record(NodeId value, int when) {
    source_.records.push_back(value);
    source_.recorded_at.push_back(when);
    return result_.records++;
  }

  void add_records(std::vector<Innovation> const& innovations) {
    result_.after = result_.records;
    for (int m = 0; m < result_.moments; ++m) record(graph_.leaf(LeafKind::state, m), after_channels);
    result_.transition = result_.records;
    for (int i = 0; i < result_.states; ++i)
      for (int k = 0; k < result_.size(); ++k) record(transition(i, k), before_channels);
    for (std::size_t c = 0; c < innovations.size(); ++c) {
      int const when = static_cast<int>(c);
      NodeId const measured = graph_.leaf(LeafKind::measured, when);
      TrackedProgram::Channel channel;
      channel.innovation = record(graph_.subtract(measured, innovations[c].mean), when);
      channel.variance = record(innovations[c].variance, when);
      channel.slopes = result_.records;
      for (int k = 0; k < result_.size(); ++k)
        record(finite_slope(graph_, channels_[c].mean, graph_.leaf(LeafKind::state, k)), when);
      channel.gains = result_.records;
      for (int k = 0; k < result_.size(); ++k)
        record(graph_.differentiate(innovations[c].correct[static_cast<std::size_t>(k)], measured), when);
      result_.channels.push_back(channel);
    }
  }

  Model const& model_;
  std::span<double const> values_;
  std::span<TrackedParameter const> tracked_;
  Graph graph_;
  std::vector<NodeId> parameter_values_;
  std::vector<NormalChannel> channels_;
  RandomStates random_;
  SimulationSource source_;
  TrackedProgram result_;
};

}  // namespace

TrackedProgram compile_tracking(Model const& model, std::span<double const> values, std::span<TrackedParameter const> tracked,
                                std::string const& method, MomentRule rule) {
  return TrackingWriter(model, values, tracked).write(method, rule);
}

}  // namespace sysid
