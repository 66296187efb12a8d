// Widths that are invalid for all values of a prior, because every draw would have zero likelihood; and those whose prior reaches
// below zero.
#include <algorithm>

#include "check/expression/value_range.hpp"
#include "check/message/errors.hpp"
#include "check/model/model_checker.hpp"

namespace sysid {
namespace {

/// Why no number of `range` in the place of argument `i` is allowed, which a positive one would be; empty where some is.
std::string_view never_allowed(DistributionRow const& row, std::size_t i, ValueRange const& range) {
  if (row.refuse == nullptr || (!range.empty && range.high > 0)) return {};
  std::vector<double> numbers(row.arguments.size(), 1.0);
  if (!row.refuse(numbers).empty()) return {};
  numbers[i] = range.empty ? -1 : std::max(range.high, -1.0);
  return row.refuse(numbers);
}

/// The probability of a negative value under a prior with numbers for arguments; 0 for any other. A copy of the graph: the model
/// need not hold these nodes, and their ids would decide the order of operands.
double negative_share(Graph graph, Distribution const& prior) {
  if (!prior.row->proper || prior.row->cumulative == nullptr) return 0;
  auto const lowest = support(graph, prior).lower;
  if (lowest && !(graph.constant_value(*lowest).value_or(0) < 0)) return 0;
  NodeId below = prior.row->cumulative(graph, graph.constant(0), prior.arguments);
  if (prior.lower) below = graph.subtract(below, prior.row->cumulative(graph, *prior.lower, prior.arguments));
  return graph.constant_value(below).value_or(0);
}

}  // namespace

void ModelChecker::report_negative_width(NodeId width, std::string const& argument, std::string const& of) {
  constexpr double hardly_any = 0.01;
  Node const& node = model_.graph[width];
  if (!is_leaf(node, LeafKind::parameter)) return;
  Parameter const& parameter = model_.parameters[static_cast<std::size_t>(node.index)];
  if (!parameter.prior || !(negative_share(model_.graph, *parameter.prior) > hardly_any)) return;
  diagnostics_.add_once(errors::width_below_zero(parameter.span, parameter.name, argument, of));
}

std::vector<std::string> ModelChecker::parameters_of(NodeId root) const {
  std::vector<std::string> names;
  for (NodeId const id : model_.graph.reachable({&root, 1}))
    if (is_leaf(model_.graph[id], LeafKind::parameter))
      names.push_back(model_.parameters[static_cast<std::size_t>(model_.graph[id].index)].name);
  return names;
}

void ModelChecker::positive_widths() {
  ValueRanges ranges(model_);
  auto const look_at = [&](Distribution const& use, Quantity const& variate) {
    for (std::size_t i = 0; i < use.arguments.size(); ++i) {
      if (std::string_view const reason = never_allowed(*use.row, i, ranges.of(use.arguments[i])); !reason.empty())
        diagnostics_.add(
            errors::never_allowed(variate.span, std::string(use.row->name), variate.name, reason, parameters_of(use.arguments[i])));
      else if (!never_allowed(*use.row, i, {-1, -1}).empty())
        report_negative_width(use.arguments[i], std::string(use.row->arguments[i].spellings.front().name), variate.name);
    }
  };
  for (Parameter const& parameter : model_.parameters)
    if (parameter.prior) look_at(*parameter.prior, parameter);
  for (Channel const& channel : model_.channels) look_at(channel.noise, channel);
  for (auto const& [law, state] : initial_laws_) look_at(law, state);
  positive_laws(ranges);
  auto const look_into = [&](Process const& process) {
    for (KernelUse const& kernel : process.kernels) {
      std::size_t k = 0;
      for (gaussian_process::HyperParameterRow const& row : kernel.row->hyper_parameters)
        for (std::size_t d = 0; d < (row.per_input ? kernel.inputs.size() : 1); ++d) {
          NodeId const node = kernel.hyper_parameters[k++];
          ValueRange const range = ranges.of(node);
          if (!range.empty && range.high > 0) {
            report_negative_width(node, std::string(row.name), process.name);
            continue;
          }
          diagnostics_.add(
              errors::hyper_parameter_never_positive(process.span, std::string(row.name), process.name, parameters_of(node)));
          return;
        }
    }
  };
  for (Process const& process : model_.processes) look_into(process);
  for (Expansion const& expansion : model_.expansions) look_into(expansion.process);
}

}  // namespace sysid
