// Leaves that cannot be reached from any root of the model.
#include "check/model/unused.hpp"

#include <vector>

#include "check/message/errors.hpp"

namespace sysid {
namespace {

using Roots = std::vector<NodeId>;

void add(Roots& roots, Distribution const& distribution) {
  roots.insert(roots.end(), distribution.arguments.begin(), distribution.arguments.end());
  for (std::optional<NodeId> const& bound : {distribution.lower, distribution.upper})
    if (bound) roots.push_back(*bound);
}

Roots results(Model const& model) {
  Roots roots = read_by(model.processes);
  roots.insert(roots.end(), model.residuals.begin(), model.residuals.end());
  roots.insert(roots.end(), model.memories.begin(), model.memories.end());
  for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
  for (Unknown const& unknown : model.unknowns) roots.push_back(unknown.guess);
  for (Channel const& channel : model.channels) add(roots, channel.noise);
  for (Derived const& derived : model.derived) roots.push_back(derived.value);
  return roots;
}

struct Read {
  std::vector<bool> parameters, inputs;
};

void mark(Model const& model, Roots const& roots, Read& read) {
  for (NodeId const id : model.graph.reachable(roots)) {
    Node const& node = model.graph[id];
    if (node.operation != Operation::leaf) continue;
    auto const index = static_cast<std::size_t>(node.index);
    if (node.leaf_kind == LeafKind::parameter) read.parameters[index] = true;
    if (node.leaf_kind == LeafKind::input || node.leaf_kind == LeafKind::input_rate) read.inputs[index] = true;
  }
}

}  // namespace

void warn_of_unused(Model const& model, Diagnostics& diagnostics) {
  Read read{std::vector<bool>(model.parameters.size()), std::vector<bool>(model.inputs.size())};
  mark(model, results(model), read);
  // A prior counts once its parameter does, and sampling order puts each parameter behind those that its prior reads.
  for (auto place = model.sampling_order.rbegin(); place != model.sampling_order.rend(); ++place) {
    auto const index = static_cast<std::size_t>(*place);
    if (!read.parameters[index]) continue;
    Roots prior;
    add(prior, *model.parameters[index].prior);
    mark(model, prior, read);
  }
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (!read.parameters[i] && !model.parameters[i].coefficient)
      diagnostics.add_once(
          errors::unused_parameter(model.parameters[i].span, model.parameters[i].name, model.parameters[i].prior.has_value()));
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    if (!read.inputs[i]) diagnostics.add_once(errors::unused_input(model.inputs[i].span, model.inputs[i].name));
}

}  // namespace sysid
