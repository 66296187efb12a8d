// Calls that reach back in time or to the channels, turned into leaves with a lag.
#include "check/expression/lags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

constexpr double most_lags = 10000;

}  // namespace

NodeId lagged(Graph& graph, NodeId root, int lag, int disturbances) {
  if (lag == 0) return root;
  return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = graph[leaf];
    switch (node.leaf_kind) {
      case LeafKind::input:
      case LeafKind::time:
      case LeafKind::measured:
      case LeafKind::previous:
        return graph.leaf(node.leaf_kind, node.index, node.stage, node.lag + lag);
      case LeafKind::unknown:  // a state at the present sample
        return graph.leaf(LeafKind::previous, node.index, Stage::begin, lag);
      case LeafKind::state:  // a disturbance at the present sample
        return graph.leaf(LeafKind::previous, disturbances + node.index, Stage::begin, lag);
      default:
        return std::nullopt;
    }
  });
}

bool Scope::is_lag_call(ast::Call const& call) const {
  static constexpr std::string_view words[] = {"lag", "lags", "measured", "predicted", "residual", "since_last"};
  return std::find(std::begin(words), std::end(words), call.function.text) != std::end(words) &&
         !functions_.contains(call.function.text);
}

std::optional<int> Scope::lag_count(ast::Expression const& tree) {
  auto const value = expression(tree);
  if (!value) return std::nullopt;
  // A count: with a unit, even that of a pure number, it is not one.
  auto const number = value->kind == Typed::Kind::literal ? graph_.constant_value(value->node) : std::nullopt;
  if (number && *number == std::floor(*number) && *number >= 0 && *number <= most_lags) return static_cast<int>(*number);
  diagnostics_.add(errors::lag_count(tree.span));
  return std::nullopt;
}

std::optional<Scope::Lags> Scope::lag_calls(ast::Call const& call) {
  if (!samples_.discrete) {
    diagnostics_.add(errors::lag_without_discrete_time(call));
    return std::nullopt;
  }
  if (call.arguments.size() != 2) {
    diagnostics_.add(errors::argument_count(call.function, call.arguments.size(), 2, 2));
    return std::nullopt;
  }
  auto const* name = std::get_if<ast::Reference>(&call.arguments[0].value.node);
  if (name != nullptr && find(name->name.text) == nullptr && samples_.channels.contains(name->name.text)) {
    diagnostics_.add(errors::channel_as_quantity(
        name->name, true,
        fmt::format("{}(measured({}), {})", call.function.text, name->name.text, unparse(call.arguments[1].value))));
    return std::nullopt;
  }
  auto const value = expression(call.arguments[0].value);
  if (value && graph_.depends(value->node, [](Node const& node) {
        return node.operation == Operation::leaf && node.leaf_kind == LeafKind::process;
      })) {
    diagnostics_.add(errors::process_out_of_place(call.span, "lagged"));
    return std::nullopt;
  }
  ast::Expression const& count = call.arguments[1].value;
  auto const* range = std::get_if<ast::Box<ast::Binary>>(&count.node);
  bool const is_range = range != nullptr && (*range)->symbol == "..";
  if (is_range != (call.function.text == "lags")) {
    diagnostics_.add(errors::lag_count(count.span));
    return std::nullopt;
  }
  auto const first = lag_count(is_range ? *(*range)->left : count);
  auto const last = is_range && first ? lag_count(*(*range)->right) : first;
  if (!value || !first || !last) return std::nullopt;
  if (*last < *first) {
    diagnostics_.add(errors::lag_count(count.span));
    return std::nullopt;
  }
  Lags lags{*first, {}};
  for (int k = *first; k <= *last; ++k) {
    lags.values.push_back(with_own_unit(*value));
    lags.values.back().node = lagged(graph_, value->node, k, samples_.states + static_cast<int>(samples_.channels.size()));
    lags.values.back().span = call.span;
  }
  return lags;
}

std::optional<Typed> Scope::channel_call(ast::Call const& call) {
  std::string const& what = call.function.text;
  if (call.arguments.size() != 1) {
    diagnostics_.add(errors::argument_count(call.function, call.arguments.size(), 1, 1));
    return std::nullopt;
  }
  auto const* name = std::get_if<ast::Reference>(&call.arguments[0].value.node);
  auto const channel = name == nullptr || name->primes > 0 ? samples_.channels.end() : samples_.channels.find(name->name.text);
  if (channel == samples_.channels.end()) {
    std::vector<std::string> known;
    for (auto const& [each, index] : samples_.channels) known.push_back(each);
    diagnostics_.add(
        errors::not_a_channel(call.arguments[0].value.span, what, name == nullptr ? std::string() : name->name.text, known));
    return std::nullopt;
  }
  if (samples_.in_equation && !samples_.discrete) {
    diagnostics_.add(errors::samples_in_differential_equation(call));
    return std::nullopt;
  }
  int const index = channel->second.index;
  NodeId const measured = graph_.leaf(LeafKind::measured, index), predicted = samples_.predicted(graph_, index, 0);
  NodeId const node = what == "measured" ? measured : what == "predicted" ? predicted : graph_.subtract(measured, predicted);
  std::optional<Unit> const& unit = channel->second.unit;
  return with_unit(node, unit && what == "residual" ? difference(*unit) : unit, call.span);
}

std::optional<Typed> Scope::change_call(ast::Call const& call) {
  if (call.arguments.size() != 1) {
    diagnostics_.add(errors::argument_count(call.function, call.arguments.size(), 1, 1));
    return std::nullopt;
  }
  if (samples_.discrete || samples_.states == 0 || samples_.in_equation) {
    diagnostics_.add(errors::change_out_of_place(call, samples_.discrete, samples_.states == 0));
    return std::nullopt;
  }
  auto value = expression(call.arguments[0].value);
  if (!value) return std::nullopt;
  auto& memories = samples_.memories;
  auto place = std::find(memories.begin(), memories.end(), value->node);
  if (place == memories.end()) place = memories.insert(memories.end(), value->node);
  value->node = graph_.subtract(value->node, samples_.memory(graph_, static_cast<int>(place - memories.begin())));
  value->unit = difference(value->unit);
  return value;
}

std::optional<Typed> Scope::lag_call(ast::Call const& call) {
  std::string const& what = call.function.text;
  if (what == "since_last") return change_call(call);
  if (what != "lag" && what != "lags") return channel_call(call);
  auto const lags = lag_calls(call);
  if (!lags) return std::nullopt;
  if (what == "lags" && lags->values.size() > 1) {
    diagnostics_.add(errors::lags_out_of_place(call));
    return std::nullopt;
  }
  return lags->values.front();
}

}  // namespace sysid
