// The fewest parentheses that keep the tree.
#include "syntax/expression_text.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>

#include "syntax/binding.hpp"

namespace sysid {
namespace {

/// `leading`: nothing stands before the expression in its statement, and no statement begins with a sign.
class Printer {
 public:
  explicit Printer(bool leading = false) : leading_(leading) {}

  std::string operator()(ast::Expression const& expression, OperatorBinding place) const {
    bool const parentheses = binding(expression) < place || (leading_ && binding(expression) == OperatorBinding::sign);
    if (parentheses) return fmt::format("({})", Printer()(expression, OperatorBinding::conditional));
    return std::visit([&](auto const& node) { return (*this)(node); }, expression.node);
  }

 private:
  std::string operator()(ast::Number const& number) const { return number_text(number.value) + bracketed(number.unit); }
  std::string operator()(ast::Text const& text) const { return string_literal(text.value); }
  std::string operator()(ast::Reference const& reference) const { return text_of(reference); }
  std::string operator()(ast::Box<ast::Unary> const& unary) const {
    if (unary->symbol == "not") return "not " + Printer()(*unary->operand, OperatorBinding::negation);
    return unary->symbol + Printer()(*unary->operand, OperatorBinding::sign);
  }
  std::string operator()(ast::Box<ast::Binary> const& binary) const {
    OperatorRow const& row = operator_row(binary->symbol);
    bool const tight = row.binding >= OperatorBinding::product || binary->symbol == "..";
    return fmt::format("{}{}{}{}{}", (*this)(*binary->left, row.left), tight ? "" : " ", binary->symbol, tight ? "" : " ",
                       Printer()(*binary->right, row.right));
  }
  std::string operator()(ast::Box<ast::Call> const& call) const { return text_of(*call); }
  std::string operator()(ast::Box<ast::Conditional> const& conditional) const {
    Printer const print;
    return fmt::format("if {} then {} else {}", print(*conditional->condition, OperatorBinding::conditional),
                       print(*conditional->then, OperatorBinding::conditional),
                       print(*conditional->otherwise, OperatorBinding::conditional));
  }
  std::string operator()(ast::Box<ast::List> const& list) const {
    return fmt::format("({})", joined(list->items, ", ", [](ast::Expression const& item) { return unparse(item); }));
  }

  bool leading_;
};

std::string parenthesised(std::vector<ast::Expression> const& items) {
  return items.empty() ? "" : fmt::format("({})", joined(items, ", ", [](auto const& item) { return unparse(item); }));
}

/// Behind the `^` of a unit: a number, a name, either with a sign, or anything in parentheses.
std::string exponent_text(ast::Expression const& exponent) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&exponent.node); unary != nullptr && (*unary)->symbol == "-") {
    ast::Expression const& operand = *(*unary)->operand;
    bool const simple = !std::holds_alternative<ast::Box<ast::Unary>>(operand.node);
    return "-" + (simple ? exponent_text(operand) : fmt::format("({})", unparse(operand)));
  }
  auto const* number = std::get_if<ast::Number>(&exponent.node);
  bool const simple = (number != nullptr && !number->unit) || std::holds_alternative<ast::Reference>(exponent.node);
  return simple ? unparse(exponent) : fmt::format("({})", unparse(exponent));
}

std::string text_of(ast::UnitFactor const& factor) {
  auto const* name = std::get_if<ast::Name>(&factor.base);
  std::string out =
      name != nullptr ? name->text : fmt::format("({})", unparse(*std::get<ast::Box<ast::UnitExpression>>(factor.base)));
  if (factor.exponent) out += "^" + exponent_text(**factor.exponent);
  return out;
}

}  // namespace

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  auto const end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  std::size_t const e = text.find('e');
  if (e == std::string::npos) return text;
  std::string const sign = text[e + 1] == '-' ? "-" : "";
  std::size_t const digits = text.find_first_not_of("+-0", e + 1);
  return text.substr(0, e + 1) + sign + text.substr(digits);
}

std::string string_literal(std::string_view text) {
  std::string out = "\"";
  for (char const c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + '"';
}

std::string bracketed(std::optional<ast::UnitExpression> const& unit) { return unit ? fmt::format(" [{}]", unparse(*unit)) : ""; }

std::string leading_text(ast::Expression const& expression) { return Printer(true)(expression, OperatorBinding::conditional); }

std::string text_of(ast::Name const& name) { return name.text; }

std::string text_of(ast::Reference const& reference) {
  std::string out = reference.name.text;
  if (!reference.index.empty())
    out += fmt::format("[{}]", joined(reference.index, ", ", [](auto const& item) { return unparse(item); }));
  return out + std::string(static_cast<std::size_t>(reference.primes), '\'');
}

std::string text_of(ast::Declared const& declared) {
  return declared.name.text + parenthesised(declared.sizes) + (declared.per_experiment ? " per experiment" : "") +
         bracketed(declared.unit);
}

std::string text_of(ast::Argument const& argument) {
  return argument.name ? fmt::format("{} = {}", argument.name->text, unparse(argument.value)) : unparse(argument.value);
}

std::string text_of(ast::Call const& call) {
  return fmt::format("{}({})", call.function.text,
                     joined(call.arguments, ", ", [](ast::Argument const& argument) { return text_of(argument); }));
}

std::string unparse(ast::UnitExpression const& unit) {
  std::string out;
  for (ast::UnitFactor const& factor : unit.factors) {
    bool const first = &factor == &unit.factors.front();
    if (factor.reciprocal)
      out += first ? "1/" : "/";
    else if (!first)
      out += " ";
    out += text_of(factor);
  }
  return out;
}

std::string unparse(ast::Expression const& expression) { return Printer()(expression, OperatorBinding::conditional); }

}  // namespace sysid
