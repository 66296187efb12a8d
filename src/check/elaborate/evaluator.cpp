// Operators and functions of the user's text in terms of numbers (names: evaluator_names.cpp). What needs no rewriting keeps its
// form: the checker reads it.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "check/elaborate/array_functions.hpp"
#include "check/elaborate/frame.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_reuse.hpp"
#include "function/table.hpp"
#include "syntax/walk.hpp"

namespace sysid {

namespace {

// Operators and definitions, one inside the other: more than a statement may hold. Each takes up to 1 kB of a stack of 8 MB.
constexpr int deepest_expression = 4500;

}  // namespace

std::optional<Array> Evaluator::evaluate(ast::Expression const& expression, Frame& frame) {
  if (depth_ == deepest_expression) algebra_.refuse(expression.span);
  if (algebra_.exhausted()) return std::nullopt;
  ++depth_;
  auto value = evaluate_node(expression, frame);
  --depth_;
  return value;
}

std::optional<Array> Evaluator::evaluate_node(ast::Expression const& expression, Frame& frame) {
  Span const span = expression.span;
  if (auto const* number = std::get_if<ast::Number>(&expression.node)) {
    ast::Number copy = *number;
    copy.unit = with_arguments(std::move(copy.unit), frame.instance.arguments);
    return scalar({{span}, std::move(copy)});
  }
  if (auto const* name = std::get_if<ast::Reference>(&expression.node)) return reference(*name, frame);
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    auto operand = evaluate(*(*unary)->operand, frame);
    return operand ? algebra_.unary((*unary)->symbol, std::move(*operand), span) : std::nullopt;
  }
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node)) {
    auto left = evaluate(*(*binary)->left, frame), right = evaluate(*(*binary)->right, frame);
    return left && right ? algebra_.binary((*binary)->symbol, std::move(*left), std::move(*right), span) : std::nullopt;
  }
  if (auto const* called = std::get_if<ast::Box<ast::Call>>(&expression.node)) return call(**called, span, frame);
  if (auto const* conditional = std::get_if<ast::Box<ast::Conditional>>(&expression.node)) {
    auto condition = evaluate(*(*conditional)->condition, frame);
    auto then = evaluate(*(*conditional)->then, frame), otherwise = evaluate(*(*conditional)->otherwise, frame);
    if (!condition || !then || !otherwise) return std::nullopt;
    return algebra_.conditional(std::move(*condition), std::move(*then), std::move(*otherwise), span);
  }
  if (auto const* list = std::get_if<ast::Box<ast::List>>(&expression.node)) {
    std::vector<Array> items;
    for (ast::Expression const& item : (*list)->items) {
      auto value = evaluate(item, frame);
      if (!value) return std::nullopt;
      items.push_back(std::move(*value));
    }
    return algebra_.list(std::move(items), span);
  }
  return scalar(expression);  // a text
}

ast::FunctionDefinition const* Evaluator::find_function_definition(Frame const& frame, std::string const& name) const {
  // Inside a function of a module, names of functions mean those of the module.
  if (function_home_ == nullptr)
    if (auto const own = frame.functions.find(name); own != frame.functions.end()) return own->second;
  Environment const& home = function_home_ != nullptr ? *function_home_ : *frame.instance.model.home;
  auto const shared = home.functions.find(name);
  return shared == home.functions.end() ? nullptr : shared->second.tree;
}

// Whether the checker can expand a function by itself: numbers only, nothing that this stage gives a meaning to.
bool Evaluator::is_plain(ast::FunctionDefinition const& function, Frame const& frame,
                         std::vector<ast::FunctionDefinition const*>& seen) const {
  if (std::find(seen.begin(), seen.end(), &function) != seen.end()) return true;
  seen.push_back(&function);
  Environment const& home = *frame.instance.model.home;
  auto const shared = home.functions.find(function.name.text);
  bool const imported = shared != home.functions.end() && shared->second.tree == &function && shared->second.home != &home;
  if (frame.outer != nullptr || imported || !home.module.empty()) return false;
  bool plain = true;
  each_expression(function.value, [&](ast::Expression const& each) {
    if (std::holds_alternative<ast::Box<ast::List>>(each.node)) plain = false;
    if (auto const* name = std::get_if<ast::Reference>(&each.node)) {
      bool const own = std::any_of(function.parameters.begin(), function.parameters.end(),
                                   [&](ast::Name const& parameter) { return parameter.text == name->name.text; });
      auto const symbol = frame.symbols.find(name->name.text);
      if (!name->index.empty() ||
          (!own && (frame.instance.arguments.contains(name->name.text) || name->name.text.find('.') != std::string::npos ||
                    (symbol != frame.symbols.end() && (symbol->second.shape.rank > 0 || !symbol->second.shape_known)))))
        plain = false;
    } else if (auto const* called = std::get_if<ast::Box<ast::Call>>(&each.node)) {
      auto const* definition = find_function_definition(frame, (*called)->function.text);
      if (definition != nullptr ? !is_plain(*definition, frame, seen) : find_array_function((*called)->function.text) != nullptr)
        plain = false;
    }
  });
  return plain;
}

std::optional<Array> Evaluator::call(ast::Call const& call, Span span, Frame& frame) {
  std::string const& name = call.function.text;
  ast::FunctionDefinition const* definition = find_function_definition(frame, name);
  ArrayFunctionRow const* row = definition == nullptr ? find_array_function(name) : nullptr;
  if (row != nullptr && row->takes_sizes) {
    std::vector<Array> none;
    return array_function(call, none, span, frame);
  }
  std::vector<Array> arguments;
  bool numbers = true, named = false;
  for (ast::Argument const& argument : call.arguments) {
    auto value = evaluate(argument.value, frame);
    if (!value) return std::nullopt;
    numbers = numbers && value->shape.rank == 0;
    named = named || argument.name;
    arguments.push_back(std::move(*value));
  }
  if (row != nullptr) return array_function(call, arguments, span, frame);
  if (definition != nullptr) {
    std::vector<ast::FunctionDefinition const*> seen;
    bool const expands = !numbers || function_home_ != nullptr || !is_plain(*definition, frame, seen);
    if (expands) return user_function(*definition, call, std::move(arguments), span, frame);
  }
  if (numbers || named || (definition == nullptr && find_function(name) == nullptr)) {
    ast::Call copy{{call.span}, call.function, {}};
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      ast::Argument const& argument = call.arguments[i];
      copy.arguments.push_back({{argument.span}, argument.name, as_expression(std::move(arguments[i]), argument.value.span)});
    }
    return scalar({{span}, ast::Box<ast::Call>(std::move(copy))});
  }
  return algebra_.each_element(call.function, std::move(arguments), span);
}

std::optional<Array> Evaluator::array_function(ast::Call const& call, std::vector<Array>& arguments, Span span,
                                               Frame const& frame) {
  ArrayFunctionRow const& row = *find_array_function(call.function.text);
  std::vector<long> sizes;
  for (ast::Argument const& argument : call.arguments) {
    if (argument.name) {
      diagnostics_.add(errors::named_argument_of_function(*argument.name, call.function.text));
      return std::nullopt;
    }
    if (!row.takes_sizes) continue;
    auto const size = whole_number(argument.value, frame.instance.arguments);
    if (!size) {
      diagnostics_.add(errors::whole_number_needed(argument.value.span, errors::named("an argument of", call.function.text)));
      return std::nullopt;
    }
    sizes.push_back(*size);
  }
  std::size_t const before = diagnostics_.all().size();
  auto result = row.apply(algebra_, arguments, sizes, span);
  if (!result && diagnostics_.all().size() == before)
    diagnostics_.add(errors::array_arguments(call.function, call.arguments.size(),
                                             std::string("write ") + std::string(row.usage) + ": " + std::string(row.summary)));
  return result;
}

std::optional<Array> Evaluator::user_function(ast::FunctionDefinition const& function, ast::Call const& call,
                                              std::vector<Array> arguments, Span span, Frame& frame) {
  for (ast::Argument const& argument : call.arguments)
    if (argument.name) {
      diagnostics_.add(errors::named_argument_of_function(*argument.name, call.function.text));
      return std::nullopt;
    }
  if (arguments.size() != function.parameters.size()) {
    diagnostics_.add(
        errors::argument_count(call.function, arguments.size(), function.parameters.size(), function.parameters.size()));
    return std::nullopt;
  }
  if (auto const begin = std::find(expanding_.begin(), expanding_.end(), &function); begin != expanding_.end()) {
    errors::Names loop;
    for (auto each = begin; each != expanding_.end(); ++each) loop.push_back((*each)->name.text + "()");
    loop.push_back(function.name.text + "()");
    diagnostics_.add(errors::definition_cycle(call.span, loop));
    return std::nullopt;
  }
  Locals local;
  for (std::size_t i = 0; i < arguments.size(); ++i) local.emplace(function.parameters[i].text, std::move(arguments[i]));
  Environment const& home = function_home_ != nullptr ? *function_home_ : *frame.instance.model.home;
  auto const shared = home.functions.find(function.name.text);
  bool const is_shared = shared != home.functions.end() && shared->second.tree == &function;
  expanding_.push_back(&function);
  auto const* outer = std::exchange(locals_, &local);
  auto const* outer_home = std::exchange(function_home_, is_shared ? shared->second.home : nullptr);
  auto result = evaluate(function.value, frame);
  locals_ = outer;
  function_home_ = outer_home;
  expanding_.pop_back();
  if (!result || !algebra_.spend(*result, span)) return std::nullopt;
  for (ast::Expression& item : result->items) item.span = span;
  return result;
}

std::optional<ast::Call> Evaluator::call_arguments(ast::Call const& call, Frame& frame) {
  ast::Call copy{{call.span}, call.function, {}};
  for (ast::Argument const& argument : call.arguments) {
    auto value = evaluate(argument.value, frame);
    if (!value) return std::nullopt;
    copy.arguments.push_back({{argument.span}, argument.name, as_expression(std::move(*value), argument.value.span)});
  }
  return copy;
}

std::optional<std::vector<ast::Call>> Evaluator::calls(ast::Call const& call, Shape const& shape, Frame& frame) {
  if (shape.rank == 0) {
    auto one = call_arguments(call, frame);
    return one ? std::optional(std::vector<ast::Call>{std::move(*one)}) : std::nullopt;
  }
  std::vector<ast::Call> result(shape.count(), ast::Call{{call.span}, call.function, {}});
  for (ast::Argument const& argument : call.arguments) {
    auto value = evaluate(argument.value, frame);
    errors::Subject const what = errors::named("an argument of", call.function.text);
    if (value) value = algebra_.fill(std::move(*value), shape, true, what, argument.value.span);
    if (!value) return std::nullopt;
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i].arguments.push_back({{argument.span}, argument.name, std::move(value->items[i])});
  }
  return result;
}

}  // namespace sysid
