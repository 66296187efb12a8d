// Leaves of disturbances become leaves of states, whose values the filter sets at every sample.
#include "likelihood/particle/particle_model.hpp"

#include "core/text/diagnostic.hpp"
#include "likelihood/compiled_model.hpp"
#include "model/replaced_disturbances.hpp"

namespace sysid {
namespace {

class Written {
 public:
  explicit Written(Model model) {
    made_.model = std::move(model);
    made_.states = static_cast<int>(made_.model.states.size());
    made_.first_start = static_cast<int>(made_.model.parameters.size());
  }

  ParticleModel write() {
    Model& model = made_.model;
    if (!model.unknowns.empty() || !model.processes.empty())
      throw InternalError("particles of a model with algebraic unknowns or processes");
    for (int i = 0; i < made_.states; ++i) write_start(model.states[static_cast<std::size_t>(i)]);
    for (Disturbance const& each : model.disturbances) add_states(each);
    for (Channel const& channel : model.channels) find_observed(channel.noise);
    replace_disturbances(model, sizes_);
    return std::move(made_);
  }

 private:
  Graph& graph() { return made_.model.graph; }

  void write_start(State& state) {
    if (!state.initial_variance) return;
    NodeId const normal = graph().leaf(LeafKind::parameter, static_cast<int>(made_.model.parameters.size()));
    Parameter number;
    number.name = "random part of " + state.name + "(0)";
    made_.model.parameters.push_back(std::move(number));
    NodeId const sd = graph().unary(Operation::square_root, *state.initial_variance);
    state.initial = graph().add(state.initial, graph().multiply(sd, normal));
    state.initial_variance.reset();
    ++made_.starts;
  }

  /// A value that stays as it is in discrete time and where it is held, else one with a constant rate.
  void add_states(Disturbance const& disturbance) {
    ParticleNoise noise;
    noise.state = static_cast<int>(made_.model.states.size());
    noise.white = made_.model.dynamics == Dynamics::continuous && !disturbance.held;
    bool const map = made_.model.dynamics == Dynamics::discrete;
    NodeId const value = graph().leaf(LeafKind::state, noise.state);
    add_state(disturbance.name, map ? value : noise.white ? graph().leaf(LeafKind::state, noise.state + 1) : graph().constant(0));
    if (noise.white) add_state(disturbance.name + "'", graph().constant(0));
    sizes_.push_back(graph().multiply(graph().unary(Operation::square_root, disturbance.intensity), value));
    made_.numbers += noise.numbers();
    made_.noises.push_back(noise);
  }

  void add_state(std::string name, NodeId derivative) {
    State state;
    state.name = std::move(name);
    state.derivative = derivative;
    state.initial = graph().constant(0);
    state.initial_given = true;
    made_.model.states.push_back(std::move(state));
  }

  void find_observed(Distribution const& noise) {
    auto const look = [&](NodeId root) {
      graph().depends(root, [&](Node const& node) {
        if (node.leaf_kind == LeafKind::disturbance && node.operation == Operation::leaf)
          made_.noises[static_cast<std::size_t>(node.index)].observed = true;
        return false;
      });
    };
    for (NodeId const argument : noise.arguments) look(argument);
    if (noise.lower) look(*noise.lower);
    if (noise.upper) look(*noise.upper);
  }

  ParticleModel made_;
  std::vector<NodeId> sizes_;  // what stands in place of each leaf
};

}  // namespace

std::shared_ptr<ParticleModel const> particle_model(Model model, std::string const& method) {
  auto made = std::make_shared<ParticleModel>(Written(std::move(model)).write());
  CompiledModel compiled;
  compiled.model = made->model;
  compiled.method = method;
  made->densities = compile_densities(compiled);
  return made;
}

}  // namespace sysid
