// Generators by their table, products over them, factors taken off from the tree.
#include "check/dictionary/term_writer.hpp"

#include <algorithm>
#include <cmath>

#include "check/elaborate/tree.hpp"
#include "check/expression/option_reader.hpp"
#include "check/message/errors.hpp"
#include "function/table.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

constexpr double most_lags = 1000;  // no dictionary has more terms

bool is_reference(ast::Expression const& tree, std::string const& name) {
  auto const* reference = std::get_if<ast::Reference>(&tree.node);
  return reference != nullptr && reference->name.text == name && reference->primes == 0;
}

/// The product without the factor `name`; nothing where it is none. `k` alone leaves 1.
std::optional<ast::Expression> without_factor(ast::Expression const& tree, std::string const& name) {
  if (is_reference(tree, name)) return tree::number(1, tree.span);
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node); unary != nullptr && (*unary)->symbol == "-") {
    auto inside = without_factor(*(*unary)->operand, name);
    if (!inside) return std::nullopt;
    return tree::unary("-", std::move(*inside), tree.span);
  }
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return std::nullopt;
  ast::Expression const &left = *(*binary)->left, &right = *(*binary)->right;
  bool const product = (*binary)->symbol == "*";
  if (product && is_reference(left, name)) return right;
  if (product && is_reference(right, name)) return left;
  if (auto inside = without_factor(left, name)) return tree::binary((*binary)->symbol, std::move(*inside), right, tree.span);
  if (!product) return std::nullopt;
  auto inside = without_factor(right, name);
  if (!inside) return std::nullopt;
  return tree::binary("*", left, std::move(*inside), tree.span);
}

}  // namespace

std::vector<WrittenTerm> TermWriter::write(ast::Expression const& item, std::set<std::string> const& free) {
  std::vector<WrittenTerm> written;
  std::size_t const before = diagnostics_.all().size();
  for (ast::Expression& tree : expanded(item)) {
    auto term = without_coefficient(std::move(tree), free);
    if (!term) return {};
    written.push_back(std::move(*term));
  }
  if (diagnostics_.has_errors(before)) return {};
  return written;
}

std::vector<ast::Expression> TermWriter::expanded(ast::Expression const& item) {
  if (ast::Call const* call = as_call(item); call != nullptr && is_lag(*call)) return past(*call, item);
  if (ast::Call const* call = as_call(item); call != nullptr && scope_.find_function_definition(call->function.text) == nullptr) {
    if (GeneratorRow const* row = find_generator(call->function.text)) return family(*call, *row, item.span);
    if (find_function(call->function.text) == nullptr) {
      diagnostics_.add(errors::unknown_generator(call->function, generator_names()));
      return {};
    }
  }
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&item.node);
  if (binary == nullptr || (*binary)->symbol != "*") {
    if (ast::Call const* family = family_inside(item)) {
      diagnostics_.add(errors::family_inside_term(family->function, item));
      return {};
    }
    return {item};
  }
  auto const left = expanded(*(*binary)->left), right = expanded(*(*binary)->right);
  std::vector<ast::Expression> products;
  for (ast::Expression const& a : left)
    for (ast::Expression const& b : right) products.push_back(tree::binary("*", a, b, item.span));
  return products;
}

ast::Call const* TermWriter::family_inside(ast::Expression const& item) const {
  ast::Call const* found = nullptr;
  each_expression(item, [&](ast::Expression const& each) {
    ast::Call const* const call = as_call(each);
    if (call == nullptr || found != nullptr) return;
    std::string const& name = call->function.text;
    if (find_generator(name) != nullptr && find_function(name) == nullptr && scope_.find_function_definition(name) == nullptr)
      found = call;
  });
  return found;
}

bool TermWriter::is_lag(ast::Call const& call) const {
  return (call.function.text == "lag" || call.function.text == "lags") &&
         scope_.find_function_definition(call.function.text) == nullptr;
}

std::vector<ast::Expression> TermWriter::past(ast::Call const& call, ast::Expression const& item) {
  auto const* range = call.arguments.size() == 2 ? std::get_if<ast::Box<ast::Binary>>(&call.arguments[1].value.node) : nullptr;
  if (range == nullptr || (*range)->symbol != "..") return {item};  // one sample, or a mistake that is reported there
  auto const first = whole(*(*range)->left), last = first ? whole(*(*range)->right) : std::nullopt;
  if (!first || !last) return {};
  if (*last < *first || *last - *first > most_lags) {
    diagnostics_.add(errors::lag_count(call.arguments[1].value.span));
    return {};
  }
  ast::Name const function{{call.function.span}, "lag"};
  std::vector<ast::Expression> samples;
  for (int k = *first; k <= *last; ++k)
    samples.push_back(tree::call(function, {call.arguments[0].value, tree::number(k, call.arguments[1].value.span)}, item.span));
  return samples;
}

std::optional<int> TermWriter::whole(ast::Expression const& tree) {
  auto const value = scope_.expression(tree);
  auto const number = value && value->kind == Typed::Kind::literal ? scope_.graph().constant_value(value->node) : std::nullopt;
  if (number && *number == std::floor(*number) && *number >= 0 && *number <= most_lags) return static_cast<int>(*number);
  if (value) diagnostics_.add(errors::lag_count(tree.span));
  return std::nullopt;
}

std::vector<ast::Expression> TermWriter::family(ast::Call const& call, GeneratorRow const& row, Span place) {
  GeneratorOption const& option = row.option;
  std::vector<ast::Expression> arguments;
  int number = 0;
  ast::Expression const* expression = nullptr;
  bool given = false, good = true;
  for (ast::Argument const& argument : call.arguments) {
    if (!argument.name) {
      ast::Call const* inner = as_call(argument.value);
      bool const lagged = inner != nullptr && is_lag(*inner);
      std::vector<ast::Expression> values = lagged ? past(*inner, argument.value) : std::vector{argument.value};
      good = !values.empty() && scope_.expression(values.front()) && good;  // said once, not of every term
      std::move(values.begin(), values.end(), std::back_inserter(arguments));
      continue;
    }
    if (argument.name->text != option.name || option.kind == GeneratorOption::Kind::none) {
      diagnostics_.add(errors::unknown_argument(*argument.name, call.function.text,
                                                option.name.empty() ? errors::Names() : errors::Names{std::string(option.name)}));
      return {};
    }
    given = true;
    if (option.kind == GeneratorOption::Kind::expression) {
      good = scope_.expression(argument.value) && good;
      expression = &argument.value;
      continue;
    }
    auto const value = scope_.expression(argument.value);
    auto const constant = value ? scope_.graph().constant_value(value->node) : std::nullopt;
    if (!value) return {};
    if (!constant || *constant != std::floor(*constant) || *constant < 1 || *constant > option.most) {
      diagnostics_.add(
          errors::generator_number(argument.value.span, std::string(option.name), option.most, std::string(option.example)));
      return {};
    }
    number = static_cast<int>(*constant);
  }
  if (!good) return {};
  if (arguments.empty() || (option.needed && !given)) {
    diagnostics_.add(errors::generator_arguments(call.function, arguments.empty() ? "arguments" : std::string(option.name),
                                                 std::string(option.example)));
    return {};
  }
  return row.make(arguments, number, expression, place);
}

std::optional<WrittenTerm> TermWriter::without_coefficient(ast::Expression tree, std::set<std::string> const& free) {
  std::vector<std::string> found;
  each_reference(tree, [&](ast::Reference const& reference) {
    if (free.contains(reference.name.text)) found.push_back(reference.name.text);
  });
  WrittenTerm term;
  if (found.empty()) {
    term.tree = std::move(tree);
  } else {
    auto rest = found.size() == 1 ? without_factor(tree, found.front()) : std::nullopt;
    if (!rest) {
      diagnostics_.add(errors::coefficient_inside(tree.span, unparse(tree)));
      return std::nullopt;
    }
    term.tree = std::move(*rest);
    term.coefficient = found.front();
  }
  term.text = unparse(term.tree);
  return term;
}

}  // namespace sysid
