// The first sign of a state in the equations; its scale is a hundredth of how fast the record moves.
#include "experiment/sticking.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/numeric/unit.hpp"
#include "experiment/motion.hpp"

namespace sysid {
namespace {

constexpr double part = 0.01;

bool is_state(Graph const& graph, NodeId node, int state) {
  return graph[node].operation == Operation::leaf && graph[node].leaf_kind == LeafKind::state && graph[node].index == state;
}

/// Root mean square of a state by a channel that measures it, or that of which it is the derivative; nothing where none does.
std::optional<double> measured_size(Model const& model, std::vector<ExperimentData> const& data, int state) {
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    NodeId const centre = model.channels[c].noise.arguments.front();
    Node const& node = model.graph[centre];
    if (node.operation != Operation::leaf || node.leaf_kind != LeafKind::state) continue;
    bool const itself = node.index == state;
    bool const integral = is_state(model.graph, model.states[static_cast<std::size_t>(node.index)].derivative, state);
    if (!itself && !integral) continue;
    double const size = motion_of(data, c, 1).size[itself ? 0 : 1];
    if (size > 0) return size;
  }
  return std::nullopt;
}

/// One significant digit.
double rounded(double value) {
  double const decade = std::pow(10.0, std::floor(std::log10(value)));
  return std::round(value / decade) * decade;
}

}  // namespace

std::string sticking_advice(Model const& model, std::vector<ExperimentData> const& data) {
  if (!model.integrated() || model.implicit) return {};
  std::vector<NodeId> derivatives;
  for (State const& state : model.states) derivatives.push_back(state.derivative);
  for (NodeId const id : model.graph.reachable(derivatives)) {
    Node const& node = model.graph[id];
    if (node.operation != Operation::sign) continue;
    Node const& argument = model.graph[node.a];
    if (argument.operation != Operation::leaf || argument.leaf_kind != LeafKind::state) continue;
    State const& state = model.states[static_cast<std::size_t>(argument.index)];
    std::string const unit = state.unit ? fmt::format(" [{}]", format_dimension(state.unit->dimension)) : "";
    std::optional<double> const size = measured_size(model, data, argument.index);
    std::string const scale = size ? fmt::format("{:.6g}{}", rounded(part * *size), unit) : "vs";
    return fmt::format(
        "where the motion sticks, `sign({0})` switches again and again, so that an adaptive solver does not get past it: write "
        "`tanh({0}/{1})` in its place{2}",
        state.name, size && !unit.empty() ? "(" + scale + ")" : scale,
        size ? fmt::format(", where the scale is a hundredth of the size of `{}` in this record", state.name)
             : fmt::format(", where `vs` is a hundredth of the usual size of `{}`", state.name));
  }
  return {};
}

}  // namespace sysid
