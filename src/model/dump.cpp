// One line per declaration, in the order of the stages; numbers are coherent SI.
#include "model/dump.hpp"

#include <fmt/format.h>

namespace sysid {
namespace {

std::string declared(Quantity const& quantity) {
  return quantity.unit ? fmt::format("{} [{}]", quantity.name, quantity.unit_of_numbers()) : quantity.name;
}

std::string present_name(Model const& model, Node const& leaf) {
  auto const index = static_cast<std::size_t>(leaf.index);
  switch (leaf.leaf_kind) {
    case LeafKind::parameter:
      return index < model.parameters.size() ? model.parameters[index].name : fmt::format("start({})", index);
    case LeafKind::unconstrained:
      return fmt::format("u({})", index);
    case LeafKind::state:
      return model.states[index].name;
    case LeafKind::input:
      return model.inputs[index].name;
    case LeafKind::input_rate:
      return model.inputs[index].name + "'";
    case LeafKind::time:
      return "time";
    case LeafKind::measured:
      return fmt::format("measured({})", model.channels[index].name);
    case LeafKind::process:
      return model.processes[index].name;
    case LeafKind::previous:
      return fmt::format("previous({})", index);
    case LeafKind::unknown:
      return index < model.unknowns.size() ? model.unknowns[index].name : fmt::format("unknown({})", index);
    case LeafKind::disturbance:  // of one with a memory what drives it
      return model.disturbances[index].state < 0 ? model.disturbances[index].name
                                                 : fmt::format("noise({})", model.disturbances[index].name);
    case LeafKind::step_size:
    case LeafKind::step_length:
      return "h";
    case LeafKind::control:
    case LeafKind::interval:
    case LeafKind::coefficient:
      break;  // of the program alone
  }
  return "?";
}

}  // namespace

std::string leaf_name(Model const& model, Node const& leaf) {
  std::string const name = present_name(model, leaf);
  return leaf.lag == 0 ? name : fmt::format("lag({}, {})", name, leaf.lag);
}

std::string dump(Model const& model) {
  auto const text = [&](NodeId node) {
    return model.graph.format(node, [&](NodeId leaf) { return leaf_name(model, model.graph[leaf]); });
  };
  auto const call = [&](Distribution const& use) {
    std::string arguments;
    for (std::size_t i = 0; i < use.arguments.size(); ++i)
      arguments +=
          fmt::format("{}{} = {}", i == 0 ? "" : ", ", use.row->arguments[i].spellings.front().name, text(use.arguments[i]));
    if (use.lower) arguments += fmt::format(", lower = {}", text(*use.lower));
    if (use.upper) arguments += fmt::format(", upper = {}", text(*use.upper));
    return fmt::format("{}({})", use.row->name, arguments);
  };
  std::string out = fmt::format("model {}{}\n", model.name, model.title.empty() ? "" : fmt::format(" \"{}\"", model.title));
  for (Quantity const& input : model.inputs) out += fmt::format("  input {}\n", declared(input));
  for (Parameter const& parameter : model.parameters)
    out += fmt::format("  parameter {}{}{}\n", declared(parameter), parameter.per_experiment ? " per experiment" : "",
                       parameter.prior   ? " ~ " + call(*parameter.prior)
                       : parameter.value ? " = " + text(*parameter.value)
                                         : "");
  for (Disturbance const& disturbance : model.disturbances)
    out += fmt::format("  disturbance {}{}, {} {}\n", declared(disturbance),
                       disturbance.state >= 0 ? " of state " + model.states[static_cast<std::size_t>(disturbance.state)].name : "",
                       disturbance.held                       ? "held, variance"
                       : model.dynamics == Dynamics::discrete ? "variance"
                                                              : "intensity",
                       text(disturbance.intensity));
  for (State const& state : model.states) {
    out += fmt::format("  state {}, initially {}{}\n", declared(state), text(state.initial),
                       state.initial_variance ? ", variance " + text(*state.initial_variance) : "");
    out += fmt::format("    {} {}\n", model.dynamics == Dynamics::discrete ? "next =" : "d/dt =", text(state.derivative));
  }
  for (std::size_t i = 0; i < model.memories.size(); ++i) out += fmt::format("  previous({}) of {}\n", i, text(model.memories[i]));
  for (Unknown const& unknown : model.unknowns)
    out += fmt::format("  unknown {}, sought from {}\n", declared(unknown), text(unknown.guess));
  for (NodeId const residual : model.residuals) out += fmt::format("    0 = {}\n", text(residual));
  for (Invariant const& invariant : model.invariants) out += fmt::format("  invariant 0 = {}\n", text(invariant.value));
  for (Process const& process : model.processes) {
    std::string arguments, kernels;
    for (NodeId const argument : process.arguments) arguments += (arguments.empty() ? "" : ", ") + text(argument);
    for (KernelUse const& kernel : process.kernels) {
      std::string values;
      for (NodeId const value : kernel.hyper_parameters) values += (values.empty() ? "" : ", ") + text(value);
      kernels += fmt::format("{}{}({})", kernels.empty() ? "" : ", ", kernel.row->name, values);
    }
    out += fmt::format("  process {} at ({}), covariance of {}\n", declared(process), arguments, kernels);
    for (ProcessCondition const& each : process.conditions)
      out += fmt::format(
          "    0 = {} at ({})\n",
          each.derivative < 0 ? "value" : "derivative in " + process.inputs[static_cast<std::size_t>(each.derivative)].name,
          fmt::join(each.point, ", "));
  }
  for (Channel const& channel : model.channels) out += fmt::format("  observe {} ~ {}\n", declared(channel), call(channel.noise));
  for (Derived const& derived : model.derived)
    out += fmt::format("  derive {} = {}{}\n", declared(derived), text(derived.value), derived.per_sample ? "  # per sample" : "");
  return out;
}

}  // namespace sysid
