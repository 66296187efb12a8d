// Expressions to nodes: operators, calls and choices, each with the units that it requires.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_reuse.hpp"
#include "function/table.hpp"
#include "syntax/words.hpp"

namespace sysid {

namespace {

constexpr std::size_t most_expressions = 2'000'000;
// Each takes up to 3 kB of a stack of 8 MB.
constexpr std::size_t deepest_tree = 1000;
// Of one file; twenty are shown.
constexpr std::size_t most_messages = 100;

bool is_sum(ast::Binary const& binary) { return binary.symbol == "+" || binary.symbol == "-"; }

/// `dy/dt`, `d2y/dt^2`, `d2y/dt2`: the two names, that of `y`, and how often it is differentiated.
struct DifferentialQuotient {
  ast::Reference const* above;
  ast::Reference const* below;
  std::string name;
  int primes;
};

/// What is squared in it, if anything.
ast::Expression const* base_of_square(ast::Expression const& tree) {
  auto const* power = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  auto const* exponent = power == nullptr ? nullptr : std::get_if<ast::Number>(&(*power)->right->node);
  bool const squared = exponent != nullptr && (*power)->symbol == "^" && exponent->value == 2 && !exponent->unit;
  return squared ? &*(*power)->left : nullptr;
}

std::optional<DifferentialQuotient> differential_quotient(ast::Binary const& binary) {
  if (binary.symbol != "/") return std::nullopt;
  ast::Expression const* last = &*binary.left;  // of the factors before it
  if (auto const* product = std::get_if<ast::Box<ast::Binary>>(&last->node); product != nullptr && (*product)->symbol == "*")
    last = &*(*product)->right;
  ast::Expression const* base = base_of_square(*binary.right);
  bool const squared = base != nullptr;
  if (!squared) base = &*binary.right;
  ast::Expression const* before = nullptr;  // `d^2` of `m*d^2*y`
  if (auto const* product = std::get_if<ast::Box<ast::Binary>>(&binary.left->node); product != nullptr && (*product)->symbol == "*")
    if (auto const* inner = std::get_if<ast::Box<ast::Binary>>(&(*product)->left->node); inner != nullptr)
      before = (*inner)->symbol == "*" ? &*(*inner)->right : &*(*product)->left;
  auto const *above = std::get_if<ast::Reference>(&last->node), *below = std::get_if<ast::Reference>(&base->node);
  if (above == nullptr || below == nullptr) return std::nullopt;
  ast::Expression const* const operand = squared && before != nullptr ? base_of_square(*before) : nullptr;
  if (auto const* letter = operand == nullptr ? nullptr : std::get_if<ast::Reference>(&operand->node);
      letter != nullptr && letter->name.text == "d" && below->name.text == "dt")
    return DifferentialQuotient{letter, below, above->name.text, 2};
  std::string const &over = above->name.text, &under = below->name.text;
  bool const twice = over.size() > 2 && (over.starts_with("d2") || over.starts_with("dd"));
  if (under != "dt" && under != "dt2") return std::nullopt;
  if (twice && (squared || under == "dt2")) return DifferentialQuotient{above, below, over.substr(2), 2};
  if (!over.starts_with("d") || over.size() == 1 || !words::begins_name(over[1]) || squared || under != "dt") return std::nullopt;
  return DifferentialQuotient{above, below, over.substr(1), 1};
}

/// A symbol of formulas: one letter or the word for a Greek one, perhaps with an index. The rest of `drag`, `dist` is none.
bool is_symbol(std::string_view name) {
  constexpr std::array<std::string_view, 8> greek{"alpha", "beta", "gamma", "theta", "phi", "psi", "omega", "rho"};
  std::string_view const letters = name.substr(0, name.find_first_of("_0123456789"));
  return letters.size() == 1 || std::find(greek.begin(), greek.end(), letters) != greek.end();
}

}  // namespace

std::optional<Typed> Scope::sum(ast::Expression const& tree, std::vector<UnitOperand>& terms, int side) {
  std::optional<Typed> value;
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node);
  if (binary != nullptr && is_sum(**binary)) {
    auto left = sum(*(*binary)->left, terms, side), right = sum(*(*binary)->right, terms, side);
    if (left && right) {
      bool const agreed = units_.one_zero(graph_, {*left, &*(*binary)->left}, {*right, &*(*binary)->right}, true);
      value = add(graph_, *left, *right, (*binary)->symbol == "-");
      if (!agreed) value->kind = Typed::Kind::wrong;
    }
  } else if (unary != nullptr && (*unary)->symbol == "-") {
    auto operand = sum(*(*unary)->operand, terms, side);
    if (operand) value = negate(graph_, *operand);
  } else {
    value = other_than_sum(tree);
    if (value) value->span = tree.span;
    if (value) terms.push_back({with_own_unit(*value), &tree, side});
  }
  if (value) {
    value->span = tree.span;
    graph_.set_span(value->node, tree.span);
  }
  return value;
}

std::optional<Typed> Scope::expression(ast::Expression const& tree) {
  std::vector<UnitOperand> terms;
  std::optional<Typed> value = sum(tree, terms);
  if (terms.size() > 1 && !units_.agree(Occasion{}, terms) && value) value->kind = Typed::Kind::wrong;
  return value;
}

std::optional<Typed> Scope::expression_in(std::optional<Unit> const& unit, Span place, ast::Expression const& tree,
                                          Occasion const& occasion) {
  std::string outer = units_.enter(occasion.kind == Occasion::Kind::distribution ? occasion.of : occasion.what);
  std::optional<Typed> value = unit ? agreeing_with(unit, place, tree, occasion) : expression(tree);
  units_.enter(std::move(outer));
  return value;
}

std::optional<Typed> Scope::agreeing_with(std::optional<Unit> const& unit, Span place, ast::Expression const& tree,
                                          Occasion const& occasion) {
  std::vector<UnitOperand> terms;
  std::optional<Typed> value = sum(tree, terms);
  UnitOperand const declared{with_unit(0, unit, place)};
  terms.push_back(declared);
  if (!units_.agree(occasion, terms) && value) value->kind = Typed::Kind::wrong;
  if (value && !occasion.is_width && !units_.one_zero(graph_, {*value, &tree}, declared, false)) value->kind = Typed::Kind::wrong;
  return value;
}

std::optional<std::pair<Typed, Typed>> Scope::equation(ast::Equation const& equation) {
  std::vector<UnitOperand> terms;
  auto left = sum(equation.left, terms, 0), right = sum(equation.right, terms, 1);
  bool agreed = units_.agree(Occasion{}, terms);
  if (!left || !right) return std::nullopt;
  agreed = agreed && units_.one_zero(graph_, {*left, &equation.left}, {*right, &equation.right}, false);
  Typed sides[] = {*left, *right};
  unify(graph_, sides);
  if (!agreed) sides[0].kind = Typed::Kind::wrong;
  return std::pair(sides[0], sides[1]);
}

Typed Scope::compared(Operation operation, UnitOperand left, UnitOperand right) {
  UnitOperand const operands[] = {std::move(left), std::move(right)};
  if (operation == Operation::conjunction || operation == Operation::disjunction) {
    units_.condition(operands[0]);
    units_.condition(operands[1]);
  } else {
    if (units_.agree({Occasion::Kind::comparison}, operands)) units_.one_zero(graph_, operands);
  }
  return compare(graph_, operation, operands[0].value, operands[1].value);
}

std::optional<Typed> Scope::binary(ast::Binary const& binary) {
  std::string const& symbol = binary.symbol;
  if (symbol == "..") {
    diagnostics_.add(errors::range_out_of_place(binary.span));
    return std::nullopt;
  }
  // A long product leans to the left: it is walked, not descended.
  std::vector<ast::Binary const*> spine = {&binary};
  while (auto const* inner = std::get_if<ast::Box<ast::Binary>>(&spine.back()->left->node)) {
    if (is_sum(**inner) || (*inner)->symbol == "..") break;
    spine.push_back(&**inner);
  }
  for (ast::Binary const* each : spine)
    if (auto const quotient = differential_quotient(*each); quotient && find(quotient->above->name.text) == nullptr)
      if (bool const declared = find(quotient->name) != nullptr;
          find(quotient->below->name.text) == nullptr && (declared || quotient->primes > 1 || is_symbol(quotient->name))) {
        Span const span = cover(quotient->above->span, each->right->span);
        diagnostics_.add(errors::quotient_as_derivative(span, *quotient->above, quotient->name, quotient->primes, declared));
        return std::nullopt;
      }
  auto value = expression(*spine.back()->left);
  for (; !spine.empty(); spine.pop_back()) {
    auto const right = expression(*spine.back()->right);
    value = value && right ? std::optional(combined(*spine.back(), *value, *right)) : std::nullopt;
    if (!value || spine.size() == 1) continue;
    value->span = spine[spine.size() - 2]->left->span;
    graph_.set_span(value->node, value->span);
  }
  return value;
}

Typed Scope::combined(ast::Binary const& binary, Typed const& left, Typed const& right) {
  std::string const& symbol = binary.symbol;
  UnitOperand const a{with_own_unit(left), &*binary.left}, b{with_own_unit(right), &*binary.right};
  if (symbol == "*") return multiply(graph_, left, right);
  if (symbol == "/") return divide(graph_, left, right);
  if (symbol == "^") {
    bool const good = units_.power(a, b, graph_.constant_value(right.node));
    Typed result = power(graph_, left, right);
    if (!good) result.kind = Typed::Kind::wrong;
    return result;
  }
  if (symbol == "<") return compared(Operation::less, a, b);
  if (symbol == "<=") return compared(Operation::less_equal, a, b);
  if (symbol == ">") return compared(Operation::less, b, a);
  if (symbol == ">=") return compared(Operation::less_equal, b, a);
  if (symbol == "==") return compared(Operation::equal, a, b);
  if (symbol == "!=") {
    Typed result = compared(Operation::equal, a, b);
    result.node = graph_.unary(Operation::negation, result.node);
    return result;
  }
  if (symbol == "and") return compared(Operation::conjunction, a, b);
  if (symbol == "or") return compared(Operation::disjunction, a, b);
  throw InternalError("operator " + symbol + " in an expression");
}

// `u(t - 1)`: `t` need not be declared for the cure to be known.
std::optional<Diagnostic> Scope::sample_in_parentheses(ast::Call const& call) const {
  std::string const& name = call.function.text;
  bool const is_channel = samples_.channels.contains(name) && find(name) == nullptr;
  if (!samples_.discrete || (find(name) == nullptr && !is_channel) || functions_.contains(name) || find_function(name) != nullptr ||
      call.arguments.size() != 1 || call.arguments.front().name)
    return std::nullopt;
  return errors::sample_by_index(call.span, call.arguments.front().value, {name, is_channel, false});
}

std::optional<Typed> Scope::function_call(ast::Call const& call) {
  if (is_lag_call(call)) return lag_call(call);
  std::string const& name = call.function.text;
  for (std::size_t i = 0; i < processes_.size(); ++i)
    if (processes_[i].definition->name.text == name) return process_call(call, i);
  if (auto refused = sample_in_parentheses(call)) {
    diagnostics_.add(std::move(*refused));
    return std::nullopt;
  }
  FunctionRow const* row = find_function(name);
  bool const is_quantity = row == nullptr && !functions_.contains(name) && find(name) != nullptr;
  if (auto refused = is_quantity ? errors::quantity_at_time(call) : std::nullopt) {
    diagnostics_.add(std::move(*refused));
    return std::nullopt;
  }
  CallArguments const arguments = call_arguments(call);
  if (auto const user = functions_.find(name); user != functions_.end()) return user_call(call, *user->second, arguments);
  if (row == nullptr) {
    std::vector<std::string> known;
    for (FunctionRow const& each : functions()) known.emplace_back(each.name);
    for (auto const& [each, definition] : functions_) known.push_back(each);
    for (ProcessName const& each : processes_) known.push_back(each.definition->name.text);
    diagnostics_.add(errors::unknown_function(call, known, is_quantity));
    return std::nullopt;
  }
  std::size_t const count = arguments.count, least = static_cast<std::size_t>(row->minimum_arguments),
                    most = static_cast<std::size_t>(row->maximum_arguments);
  bool const branches = row->unit_rule == UnitRule::branches;
  if (branches && arguments.counted && count >= 2 && count % 2 == 0) {
    diagnostics_.add(errors::piecewise_without_otherwise(call));
    return std::nullopt;
  }
  if (arguments.counted && (count < least || count > most)) {
    diagnostics_.add(errors::argument_count(call.function, count, least, most));
    return std::nullopt;
  }
  if (row->unit_rule == UnitRule::branches && arguments.counted && count % 2 == 0) {
    diagnostics_.add(errors::piecewise_without_otherwise(call));
    return std::nullopt;
  }
  if (!arguments.good) return std::nullopt;
  return built_in(*row, arguments.values);
}

Scope::CallArguments Scope::call_arguments(ast::Call const& call) {
  CallArguments result;
  for (ast::Argument const& argument : call.arguments) {
    if (auto const* inner = std::get_if<ast::Box<ast::Call>>(&argument.value.node);
        inner != nullptr && !argument.name && (*inner)->function.text == "lags" && is_lag_call(**inner)) {
      auto const lags = lag_calls(**inner);
      result.good = result.good && lags;
      result.counted = result.counted && lags;
      if (!lags) continue;
      result.count += lags->values.size();
      for (Typed const& lag : lags->values) result.values.push_back({with_own_unit(lag), &argument.value});
      continue;
    }
    auto const* range = std::get_if<ast::Box<ast::Binary>>(&argument.value.node);
    result.counted = result.counted && !(range != nullptr && (*range)->symbol == "..");
    ++result.count;
    bool const known = functions_.contains(call.function.text) || find_function(call.function.text) != nullptr;
    if (argument.name && known) {
      diagnostics_.add(errors::named_argument_of_function(*argument.name, call.function.text));
      result.good = false;
    }
    auto value = expression(argument.value);
    result.good = result.good && value;
    if (value) result.values.push_back({with_own_unit(*value), &argument.value});
  }
  return result;
}

std::optional<Typed> Scope::user_call(ast::Call const& call, ast::FunctionDefinition const& function,
                                      CallArguments const& arguments) {
  if (!arguments.good) return std::nullopt;
  std::size_t const wanted = function.parameters.size();
  if (arguments.values.size() != wanted) {
    diagnostics_.add(errors::argument_count(call.function, arguments.values.size(), wanted, wanted));
    return std::nullopt;
  }
  std::string const& name = call.function.text;
  std::string const key = name + "()";
  if (auto const begin = std::find(resolving_.begin(), resolving_.end(), key); begin != resolving_.end()) {
    std::vector<std::string> loop(begin, resolving_.end());
    loop.push_back(key);
    diagnostics_.add(errors::definition_cycle(call.span, loop));
    return std::nullopt;
  }
  Arguments local;
  for (std::size_t i = 0; i < wanted; ++i) local.emplace(function.parameters[i].text, arguments.values[i].value);
  resolving_.push_back(key);
  auto const* outer = std::exchange(arguments_, &local);
  units_.enter_call(call.span, name);
  auto value = expression(function.value);
  units_.leave_call();
  arguments_ = outer;
  resolving_.pop_back();
  if (value) value->span = call.span;
  return value;
}

Typed Scope::built_in(FunctionRow const& row, std::span<UnitOperand const> arguments) {
  std::string const name(row.name);
  bool agreed = true;
  switch (row.unit_rule) {
    case UnitRule::same:
    case UnitRule::ratio:
      agreed = units_.agree({Occasion::Kind::arguments, name}, arguments) && units_.one_zero(graph_, arguments);
      break;
    case UnitRule::dimensionless:
    case UnitRule::angle:
      for (UnitOperand const& argument : arguments)
        agreed = units_.pure(name, argument, row.unit_rule == UnitRule::angle) && agreed;
      break;
    case UnitRule::branches: {  // condition, value, condition, value, ..., otherwise
      std::vector<UnitOperand> branches;
      for (std::size_t i = 0; i < arguments.size(); ++i) {
        bool const condition = i % 2 == 0 && i + 1 < arguments.size();
        if (condition)
          agreed = units_.condition(arguments[i], true) && agreed;
        else
          branches.push_back(arguments[i]);
      }
      agreed = units_.agree({Occasion::Kind::branches, name}, branches) && units_.one_zero(graph_, branches) && agreed;
      break;
    }
    case UnitRule::root:
    case UnitRule::none:
      break;
  }
  std::vector<Typed> values;
  for (UnitOperand const& argument : arguments) values.push_back(argument.value);
  Typed result = call(graph_, row, std::move(values));
  if (!agreed && row.unit_rule != UnitRule::ratio) result.kind = Typed::Kind::wrong;
  return result;
}

bool Scope::affordable(Span span) {
  if (diagnostics_.all().size() >= most_messages && diagnostics_.has_errors()) return false;
  if (!too_large_ && ++expressions_ <= most_expressions && depth_ <= deepest_tree) return true;
  if (!too_large_) diagnostics_.add(errors::model_too_large(span));
  too_large_ = true;
  return false;
}

std::optional<Typed> Scope::other_than_sum(ast::Expression const& tree) {
  std::optional<Typed> value;
  if (!affordable(tree.span)) return value;
  ++depth_;
  if (auto const* number = std::get_if<ast::Number>(&tree.node)) {
    if (!number->unit) {
      value = literal(graph_, number->value, tree.span);
    } else if (auto const unit = this->unit(number->unit)) {
      value = tagged(graph_, number->value, *unit, tree.span);
    }
  } else if (auto const* text = std::get_if<ast::Text>(&tree.node)) {
    diagnostics_.add(errors::not_a_number(text->span, {"a text"}));
  } else if (auto const* name = std::get_if<ast::Reference>(&tree.node)) {
    value = reference(*name);
  } else if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) {
    auto operand = expression(*(*unary)->operand);
    if (operand) {
      units_.condition({*operand, &*(*unary)->operand});
      value = with_unit(graph_.unary(Operation::negation, operand->node), Unit{}, tree.span);
    }
  } else if (auto const* operation = std::get_if<ast::Box<ast::Binary>>(&tree.node)) {
    value = binary(**operation);
  } else if (auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) {
    value = function_call(**call);
  } else if (auto const* conditional = std::get_if<ast::Box<ast::Conditional>>(&tree.node)) {
    value = choice(**conditional);
  } else {
    diagnostics_.add(errors::list_here(tree.span));
  }
  --depth_;
  return value;
}

std::optional<Typed> Scope::choice(ast::Conditional const& conditional) {
  auto const condition = expression(*conditional.condition);
  auto const then = expression(*conditional.then), otherwise = expression(*conditional.otherwise);
  bool const true_or_false = !condition || units_.condition({*condition, &*conditional.condition});
  if (!condition || !then || !otherwise) return std::nullopt;
  UnitOperand const branches[] = {{with_own_unit(*then), &*conditional.then}, {with_own_unit(*otherwise), &*conditional.otherwise}};
  bool const agreed = units_.agree({Occasion::Kind::branches}, branches) && units_.one_zero(graph_, branches);
  Typed result = select(graph_, *condition, *then, *otherwise);
  if (!agreed || !true_or_false) result.kind = Typed::Kind::wrong;
  return result;
}

}  // namespace sysid
