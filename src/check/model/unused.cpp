// Leaves that cannot be reached from any root of the model.
#include "check/model/unused.hpp"

#include <string_view>
#include <vector>

#include "check/expression/leaves.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"

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
  for (State const& state : model.states) {
    roots.insert(roots.end(), {state.derivative, state.initial});
    if (state.initial_variance) roots.push_back(*state.initial_variance);
  }
  for (Disturbance const& disturbance : model.disturbances) roots.push_back(disturbance.intensity);
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

namespace {

Read read_in(Model const& model) {
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
  return read;
}

bool reads_disturbance(Model const& model, Disturbance const& disturbance) {
  Roots roots = model.residuals;
  for (std::size_t i = 0; i < model.states.size(); ++i)
    if (static_cast<int>(i) != disturbance.state) roots.push_back(model.states[i].derivative);
  for (Channel const& channel : model.channels) add(roots, channel.noise);
  bool const is_state = disturbance.state >= 0;
  int const index = is_state ? disturbance.state : static_cast<int>(&disturbance - model.disturbances.data());
  for (NodeId const id : model.graph.reachable(roots))
    if (is_leaf(model.graph[id], is_state ? LeafKind::state : LeafKind::disturbance) && model.graph[id].index == index) return true;
  return false;
}

/// "law" of "law(n = 2)": models of one text.
std::string_view text_name(Model const& model) { return std::string_view(model.name).substr(0, model.name.find('(')); }

}  // namespace

void warn_of_unused(std::span<Model const> models, Diagnostics& diagnostics) {
  std::vector<Read> read;
  for (Model const& model : models) read.push_back(read_in(model));
  // A term that an argument of 0 takes out leaves its coefficient to the models in which it stands.
  auto const elsewhere = [&](Model const& model, auto const& is_read) {
    for (std::size_t m = 0; m < models.size(); ++m)
      if (text_name(models[m]) == text_name(model) && is_read(m)) return true;
    return false;
  };
  for (std::size_t m = 0; m < models.size(); ++m) {
    Model const& model = models[m];
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      Parameter const& parameter = model.parameters[i];
      if (read[m].parameters[i] || parameter.coefficient) continue;
      bool const other = elsewhere(model, [&](std::size_t o) {
        for (std::size_t p = 0; p < models[o].parameters.size(); ++p)
          if (models[o].parameters[p].name == parameter.name && read[o].parameters[p]) return true;
        return false;
      });
      if (!other) diagnostics.add_once(errors::unused_parameter(parameter.span, parameter.name, parameter.prior.has_value()));
    }
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      bool const other = elsewhere(model, [&](std::size_t o) {
        for (std::size_t p = 0; p < models[o].inputs.size(); ++p)
          if (models[o].inputs[p].name == model.inputs[i].name && read[o].inputs[p]) return true;
        return false;
      });
      if (!other) diagnostics.add_once(errors::unused_input(model.inputs[i].span, model.inputs[i].name));
    }
  }
}

void refuse_unused_disturbances(std::span<Model const> models, Diagnostics& diagnostics) {
  for (Model const& model : models)
    for (Disturbance const& disturbance : model.disturbances) {
      if (model.channels.empty()) continue;  // a part, whose whole reads it
      bool const read = std::any_of(models.begin(), models.end(), [&](Model const& other) {
        if (text_name(other) != text_name(model)) return false;
        return std::any_of(other.disturbances.begin(), other.disturbances.end(), [&](Disturbance const& each) {
          return each.name == disturbance.name && reads_disturbance(other, each);
        });
      });
      if (!read) diagnostics.add_once(errors::unused_disturbance(disturbance.span, disturbance.name));
    }
}

}  // namespace sysid
