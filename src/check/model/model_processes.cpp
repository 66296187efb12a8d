// Gaussian processes of a model: what they read, and where their values may stand.
#include <algorithm>

#include "check/message/errors.hpp"
#include "check/model/model_checker.hpp"

namespace sysid {
namespace {

bool reads_process(Graph const& graph, NodeId root) {
  return graph.depends(root, [](Node const& node) { return is_leaf(node, LeafKind::process); });
}

/// Whether `root` is a sum that has the leaf once, with a plus sign.
bool is_addend(Graph const& graph, NodeId root, std::function<bool(Node const&)> const& is_this) {
  Node const node = graph[root];
  if (is_this(node)) return true;
  if (node.operation != Operation::add && node.operation != Operation::subtract) return false;
  bool const left = graph.depends(node.a, is_this), right = graph.depends(node.b, is_this);
  if (left == right) return false;
  return left ? is_addend(graph, node.a, is_this) : node.operation == Operation::add && is_addend(graph, node.b, is_this);
}

/// Whether `root` is a sum in which it stands in more than one addend.
bool is_added_twice(Graph const& graph, NodeId root, std::function<bool(Node const&)> const& is_this) {
  Node const node = graph[root];
  if (node.operation == Operation::negate) return is_added_twice(graph, node.a, is_this);
  if (node.operation != Operation::add && node.operation != Operation::subtract) return false;
  bool const left = graph.depends(node.a, is_this), right = graph.depends(node.b, is_this);
  return (left && right) || (left && is_added_twice(graph, node.a, is_this)) || (right && is_added_twice(graph, node.b, is_this));
}

bool same_leaf(Node const& a, Node const& b) { return is_leaf(a, b.leaf_kind) && a.index == b.index; }

}  // namespace

void ModelChecker::shared_by_all(Process const& process, Span call) {
  for (KernelUse const& kernel : process.kernels)
    for (NodeId const hyper_parameter : kernel.hyper_parameters)
      for (NodeId const node : model_.graph.reachable({&hyper_parameter, 1}))
        if (is_leaf(model_.graph[node], LeafKind::parameter) && !failed())
          if (Parameter const& own = model_.parameters[static_cast<std::size_t>(model_.graph[node].index)]; own.per_experiment)
            diagnostics_.add(errors::process_of_one_experiment(call, process.name, own.name));
}

void ModelChecker::processes() {
  for (Scope::ProcessName const& each : scope_.processes()) {
    if (each.expansion) {
      Expansion expansion = *each.expansion;
      shared_by_all(expansion.process, each.call);
      for (std::vector<NodeId>& application : expansion.applications)
        for (NodeId& argument : application) argument = solved(argument);
      model_.expansions.push_back(std::move(expansion));
      continue;
    }
    if (!each.use) {
      diagnostics_.add(errors::process_never_applied(each.definition->name));
      continue;
    }
    Process process = *each.use;
    for (NodeId& argument : process.arguments) argument = solved(argument);
    shared_by_all(process, each.call);
    model_.processes.push_back(std::move(process));
  }
  if (!model_.processes.empty() && !model_.expansions.empty())
    diagnostics_.add(errors::expansion_beside_process(model_.processes.front().span, model_.processes.front().name,
                                                      model_.expansions.front().name));
}

void ModelChecker::resolve_process_arguments(std::vector<NodeId> const& predicted) {
  Graph& graph = model_.graph;
  int const states = static_cast<int>(states_.size()), channels = static_cast<int>(predicted.size());
  for (Process& process : model_.processes)
    for (NodeId& argument : process.arguments)
      argument = graph.substitute(argument, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph[leaf];
        if (node.leaf_kind != LeafKind::previous || node.index < states) return std::nullopt;
        if (node.lag == 0) return without_processes(graph, predicted[static_cast<std::size_t>(node.index - states)]);
        return graph.leaf(LeafKind::previous, node.index + channels, Stage::begin, node.lag);
      });
  for (Process const& process : model_.processes)
    for (NodeId const argument : process.arguments)
      if (reads_process(graph, argument) && !failed())
        diagnostics_.add(errors::process_out_of_place(process.span, "in the arguments of a Gaussian process"));
}

void ModelChecker::place_processes() {
  Graph& graph = model_.graph;
  for (std::size_t p = 0; p < model_.processes.size(); ++p) {
    Process& process = model_.processes[p];
    Span const call = scope_.processes()[p].call;
    auto const is_this = [&](Node const& node) { return is_leaf(node, LeafKind::process) && node.index == static_cast<int>(p); };
    for (std::size_t c = 0; c < model_.channels.size(); ++c) {
      Channel const& channel = model_.channels[c];
      if (std::none_of(channel.noise.arguments.begin(), channel.noise.arguments.end(),
                       [&](NodeId argument) { return graph.depends(argument, is_this); }))
        continue;
      if (process.channel >= 0) {
        diagnostics_.add(errors::process_of_two_channels(
            call, process.name, model_.channels[static_cast<std::size_t>(process.channel)].name, channel.name));
        return;
      }
      process.channel = static_cast<int>(c);
      auto const is_own = [&](Node const& node) {
        return is_leaf(node, LeafKind::measured) && node.index == static_cast<int>(c) && node.lag == 0;
      };
      if (std::ranges::any_of(process.arguments, [&](NodeId argument) { return graph.depends(argument, is_own); })) {
        diagnostics_.add(errors::own_sample_in_function(call, process.name, channel.name));
        return;
      }
      if (!channel.noise.row->gaussian) {
        diagnostics_.add(errors::process_without_normal_noise(channel.span, channel.name, std::string(channel.noise.row->name)));
        return;
      }
      NodeId const centre = channel.noise.row->centre(graph, channel.noise.arguments);
      for (NodeId const argument : channel.noise.arguments)
        if (argument != centre && (reads_process(graph, argument) || !moving_part(graph, argument).empty())) {
          diagnostics_.add(errors::process_with_moving_noise(channel.span, channel.name));
          return;
        }
      for (NodeId const id : graph.reachable(channel.noise.arguments))
        if (is_leaf(graph[id], LeafKind::parameter) &&
            !graph.depends(centre, [&](Node const& node) { return same_leaf(node, graph[id]); }))
          if (Parameter const& own = model_.parameters[static_cast<std::size_t>(graph[id].index)]; own.per_experiment) {
            diagnostics_.add(errors::process_of_one_experiment(call, process.name, own.name));
            return;
          }
      if (!is_addend(graph, centre, is_this)) {
        diagnostics_.add(is_added_twice(graph, centre, is_this) ? errors::process_added_twice(call, process.name, channel.name)
                                                                : errors::process_no_addend(call, process.name, channel.name));
        return;
      }
    }
    if (process.channel < 0) {
      diagnostics_.add(errors::process_unobserved(call, process.name));
      return;
    }
  }
  for (std::size_t c = 0; c < model_.channels.size() && !model_.processes.empty(); ++c)
    if (std::none_of(model_.processes.begin(), model_.processes.end(),
                     [&](Process const& process) { return process.channel == static_cast<int>(c); })) {
      diagnostics_.add(errors::channel_without_process(model_.channels[c].span, model_.channels[c].name));
      return;
    }
  // A state that holds a process is shown as what its channel predicts.
  std::erase_if(model_.derived, [&](Derived const& derived) { return reads_process(graph, derived.value); });
}

}  // namespace sysid
