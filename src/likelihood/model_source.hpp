// A model as sources of programs: its dynamics and the noise of its channels, with what is fixed for all experiments folded in.
#pragma once
#include <optional>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "model/model.hpp"
#include "program/moments/moments.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// The graph of a model with parameters that are fixed for all experiments replaced by their values; the replaced roots share it.
class Folded {
 public:
  /// unknowns_are_states: leaf unknown(j) is the state that comes j places after the model's own (algebraic states of IDA).
  explicit Folded(Model const& model, bool unknowns_are_states = false)
      : model_(model), unknowns_are_states_(unknowns_are_states), graph(model.graph) {}

  NodeId operator()(NodeId root);
  Distribution operator()(Distribution use);

 private:
  Model const& model_;
  bool unknowns_are_states_;

 public:
  Graph graph;
};

/// Whether a program keeps the model's unknowns as algebraic states: not where they could be solved for and the solver wants y' =
/// f.
bool keeps_unknowns(CompiledModel const& compiled);

/// What the programs of a model are made of, expressions of `Folded::graph`.
struct ModelSource {
  SimulationSource dynamics;        // without channels and records
  std::vector<Distribution> noise;  // per channel; where states are random, of a sample given those before it
  /// Per channel, of models with random states: ChannelSource::correct; else empty.
  std::vector<std::vector<NodeId>> correct;
  /// Their covariances; absent where the states are known.
  std::optional<Moments> moments;

  /// A channel that sums this and corrects the states.
  ChannelSource channel(std::size_t index, std::vector<NodeId> sums) const;
  /// When a record of its sample is computed.
  int recorded_with(std::size_t channel) const { return moments ? static_cast<int>(channel) : before_channels; }
  /// The variance that random states give to an expression of them, to first order; 0 where they are known.
  NodeId variance(Graph& graph, NodeId expression) const;
};
/// since: of a model with random states, how they vary together with those of the last sample (SincePastSample).
ModelSource source_of(Folded& folded, CompiledModel const& compiled, bool since = false);

/// log density of a channel's sample in the declared unit; the largest any location gives it; and where the noise is centred.
struct ChannelDensity {
  NodeId sample, saturated, centre;
};
ChannelDensity channel_density(Graph& graph, Distribution const& noise, Channel const& channel, int index);

/// sign(y - centre) sqrt(2 (saturated - log p(y)))
NodeId deviance_residual(Graph& graph, ChannelDensity const& density, int index);
/// (y - mean)/sd of normal noise: the same, with a derivative at 0.
NodeId standardised(Graph& graph, Distribution const& noise, int index);

}  // namespace sysid
