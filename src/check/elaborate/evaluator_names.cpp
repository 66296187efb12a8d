// Names of the user's text in terms of numbers: elements of arrays, samples, values of definitions and of what a use of a model
// binds, and their rates over time.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "check/elaborate/derivative.hpp"
#include "check/elaborate/frame.hpp"
#include "check/elaborate/tree.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_reuse.hpp"

namespace sysid {

std::optional<Array> Evaluator::value_of(Frame& frame, std::string const& name, FrameSymbol& symbol) {
  if (symbol.evaluated) return symbol.array;
  symbol.evaluating = true;
  auto const* locals = std::exchange(locals_, nullptr);
  auto const* home = std::exchange(function_home_, nullptr);
  auto value = evaluate(*symbol.value, *symbol.value_frame);
  locals_ = locals;
  function_home_ = home;
  symbol.evaluating = false;
  symbol.evaluated = true;
  if (value && symbol.shape_known) {
    std::string const path = symbol.bound() ? frame.prefix + name : name;
    value = algebra_.fill(std::move(*value), symbol.shape, true, errors::named("the value of", path), symbol.value->span);
  } else if (value) {
    symbol.shape = value->shape;
  }
  symbol.shape_known = true;
  if (value)
    for (std::size_t i = 0; i < value->items.size(); ++i)
      definitions_[element_name(frame.prefix + name, symbol.shape, i)] = value->items[i];
  return symbol.array = std::move(value);
}

// `u[t-1]` where time is discrete; an index that is a whole number is that of an element.
std::optional<Diagnostic> Evaluator::sample_index(ast::Reference const& reference, Frame const& frame, bool is_channel) const {
  Frame const* whole = &frame;
  while (whole->outer != nullptr) whole = whole->outer;
  auto const& statements = whole->model().statements;
  bool const discrete = std::any_of(statements.begin(), statements.end(), [](ast::ModelStatement const& each) {
    return std::holds_alternative<ast::DiscreteTimeDeclaration>(each);
  });
  if (!discrete || reference.index.size() != 1) return std::nullopt;
  bool const negative = std::holds_alternative<ast::Box<ast::Unary>>(reference.index.front().node);
  if (!negative && whole_number(reference.index.front(), frame.instance.arguments)) return std::nullopt;
  return errors::sample_by_index(reference.span, reference.index.front(), {reference.name.text, is_channel});
}

std::optional<Array> Evaluator::element(Array array, ast::Reference const& reference, Frame const& frame) {
  if (reference.index.empty()) return array;
  Span const span = cover(reference.index.front().span, reference.index.back().span);
  if (auto refused = sample_index(reference, frame, false)) {
    diagnostics_.add(std::move(*refused));
    return std::nullopt;
  }
  if (static_cast<int>(reference.index.size()) != array.shape.rank) {
    diagnostics_.add(errors::index_count(span, reference.name.text, array.shape, reference.index.size()));
    return std::nullopt;
  }
  long place[2] = {1, 1};
  for (std::size_t i = 0; i < reference.index.size(); ++i) {
    auto const index = whole_number(reference.index[i], frame.instance.arguments);
    if (!index) {
      diagnostics_.add(errors::whole_number_needed(reference.index[i].span, {"an index"}));
      return std::nullopt;
    }
    if (*index < 1 || *index > (i == 0 ? array.shape.rows : array.shape.columns)) {
      diagnostics_.add(errors::index_out_of_range(reference.index[i].span, reference.name.text, array.shape));
      return std::nullopt;
    }
    place[i] = *index;
  }
  return scalar(array.at(static_cast<int>(place[0] - 1), static_cast<int>(place[1] - 1)));
}

std::optional<Array> Evaluator::reference(ast::Reference const& reference, Frame& frame) {
  std::string const& name = reference.name.text;
  auto const without_primes = [&](Array array, char const* what) -> std::optional<Array> {
    if (reference.primes == 0) return element(std::move(array), reference, frame);
    diagnostics_.add(errors::primes_on(reference, what));
    return std::nullopt;
  };
  if (locals_ != nullptr)
    if (auto const local = locals_->find(name); local != locals_->end())
      return without_primes(local->second, "an argument of this function");
  if (auto const argument = frame.instance.arguments.find(name); argument != frame.instance.arguments.end())
    return without_primes(scalar(tree::number(static_cast<double>(argument->second), reference.span)), "an argument of the model");
  Found const found = find(frame, name);
  return found.symbol != nullptr ? declared(reference, found, frame) : undeclared(reference, frame);
}

// Channels, `pi`, and what is not declared: the checker knows better.
std::optional<Array> Evaluator::undeclared(ast::Reference const& reference, Frame const& frame) {
  auto const& statements = frame.model().statements;
  bool const is_channel = std::any_of(statements.begin(), statements.end(), [&](ast::ModelStatement const& each) {
    auto const* observation = std::get_if<ast::Observation>(&each);
    return observation != nullptr && observation->channel.name.text == reference.name.text;
  });
  if (auto refused = is_channel ? sample_index(reference, frame, true) : std::nullopt) {
    diagnostics_.add(std::move(*refused));
    return std::nullopt;
  }
  ast::Reference copy = reference;
  copy.index.clear();
  std::string indices;
  for (ast::Expression const& index : reference.index) {
    auto const number = whole_number(index, frame.instance.arguments);
    if (!number) {
      diagnostics_.add(errors::whole_number_needed(index.span, {"an index"}));
      return std::nullopt;
    }
    indices += fmt::format("{}{}", indices.empty() ? "" : ", ", *number);
  }
  if (!indices.empty()) copy.name.text += "[" + indices + "]";
  return scalar({{reference.span}, std::move(copy)});
}

std::optional<Array> Evaluator::declared(ast::Reference const& reference, Found const& found, Frame const& frame) {
  FrameSymbol& symbol = *found.symbol;
  bool const defined = symbol.value != nullptr;
  if (symbol.kind == FrameSymbol::Kind::time && !time_name.empty()) {
    motions_[time_name] = OverTime::Kind::time;
    return element(scalar(tree::reference(time_name, reference.primes, reference.span)), reference, frame);
  }
  std::optional<Array> value;
  if (defined && !symbol.evaluating) {
    value = value_of(*found.frame, found.name, symbol);
    if (!value) return std::nullopt;
  }
  bool const bound_input = symbol.bound() && symbol.kind == FrameSymbol::Kind::input;
  if (reference.primes > 0 && value && symbol.shape.rank > 0 && !bound_input) {
    diagnostics_.add(errors::primes_on_array(reference));
    return std::nullopt;
  }
  std::string const flat = found.frame->prefix + found.name;
  Array array{symbol.shape, {}};
  for (std::size_t i = 0; i < symbol.shape.count(); ++i) {
    std::string const each = element_name(flat, symbol.shape, i);
    // A plain number among the elements stays one, so that it adapts to what it meets.
    bool const plain =
        reference.primes == 0 && value && symbol.shape.rank > 0 && !symbol.declared->unit && tree::is_plain_number(value->items[i]);
    if (plain) {
      array.items.push_back(value->items[i]);
    } else if (bound_input && reference.primes > 0 && value) {
      auto derived = rate(value->items[i], reference.primes, reference.span, flat);
      if (!derived) return std::nullopt;
      array.items.push_back(std::move(*derived));
    } else {
      if (!defined) motions_[each] = symbol.kind == FrameSymbol::Kind::parameter ? OverTime::Kind::still : OverTime::Kind::moving;
      array.items.push_back(tree::reference(each, reference.primes, reference.span));
    }
  }
  return element(std::move(array), reference, frame);
}

std::optional<OverTime> Evaluator::motion_of(std::string const& name) const {
  if (auto const motion = motions_.find(name); motion != motions_.end()) return OverTime{motion->second, nullptr};
  if (auto const definition = definitions_.find(name); definition != definitions_.end())
    return OverTime{OverTime::Kind::defined, &definition->second};
  if (name == "pi" || name == "inf") return OverTime{OverTime::Kind::still, nullptr};
  return std::nullopt;
}

std::optional<ast::Expression> Evaluator::rate(ast::Expression expression, int primes, Span use, std::string const& input) {
  Span const binding = expression.span;
  for (; primes > 0; --primes) {
    std::size_t left = algebra_.left();
    auto derived = time_derivative(
        expression, [&](std::string const& name) { return motion_of(name); }, left);
    if (!derived && left == 0) {
      algebra_.refuse(use);
      return std::nullopt;
    }
    if (!derived) {
      diagnostics_.add(errors::no_rate_of_binding(use, binding, input));
      return std::nullopt;
    }
    expression = std::move(*derived);
    if (!algebra_.spend(scalar(expression), use)) return std::nullopt;
  }
  return expression;
}

}  // namespace sysid
