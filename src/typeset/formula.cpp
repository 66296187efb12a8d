// One visitor over the tree. Fractions and exponents hold what stands in them together, so that it needs no parentheses.
#include "typeset/formula.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text/utf8.hpp"
#include "syntax/binding.hpp"
#include "syntax/expression_text.hpp"

namespace sysid {

namespace {

/// Functions whose printed name is another one.
struct FunctionName {
  std::string_view name, printed;
};
constexpr std::array<FunctionName, 5> function_names{
    {{"log", "ln"}, {"sign", "sgn"}, {"asin", "arcsin"}, {"acos", "arccos"}, {"atan", "arctan"}}};

std::string_view printed_function(std::string_view name) {
  auto const* const row =
      std::find_if(function_names.begin(), function_names.end(), [&](FunctionName const& each) { return each.name == name; });
  return row == function_names.end() ? name : row->printed;
}

/// "log_uniform" as "LogUniform".
std::string camel_case(std::string_view name) {
  std::string out;
  bool capital = true;
  for (char const c : name) {
    if (c == '_')
      capital = true;
    else
      out += capital && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    if (c != '_') capital = false;
  }
  return out;
}

Sign sign_of(std::string_view symbol) {
  struct Row {
    std::string_view symbol;
    Sign sign;
  };
  constexpr std::array<Row, 11> rows{{{"+", Sign::plus},
                                      {"-", Sign::minus},
                                      {"<", Sign::less},
                                      {"<=", Sign::less_equal},
                                      {">", Sign::greater},
                                      {">=", Sign::greater_equal},
                                      {"==", Sign::equal_to},
                                      {"!=", Sign::not_equal},
                                      {"and", Sign::conjunction},
                                      {"or", Sign::disjunction},
                                      {"..", Sign::range}}};
  for (Row const& row : rows)
    if (row.symbol == symbol) return row.sign;
  return Sign::times;
}

ast::Expression const* only_argument(ast::Call const& call) {
  return call.arguments.size() == 1 && !call.arguments.front().name ? &call.arguments.front().value : nullptr;
}

/// Written behind a brace that nothing closes.
bool is_cases(ast::Call const& call) { return call.function.text == "piecewise" && call.arguments.size() >= 3; }

ast::Expression const* named(ast::Call const& call, std::string_view name) {
  for (ast::Argument const& argument : call.arguments)
    if (argument.name && argument.name->text == name) return &argument.value;
  return nullptr;
}

/// Whether print begins with a digit, which a thin space before it would not keep apart from a factor.
bool begins_with_digit(ast::Expression const& expression) {
  if (std::holds_alternative<ast::Number>(expression.node)) return true;
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node))
    return (*binary)->symbol != "/" && begins_with_digit(*(*binary)->left);
  return false;
}

/// Whether print begins with a minus, which would look like a difference behind another factor or sign.
bool begins_with_sign(ast::Expression const& expression) {
  if (auto const* number = std::get_if<ast::Number>(&expression.node)) return std::signbit(number->value);
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) return (*unary)->symbol == "-";
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node))
    return (*binary)->symbol == "*" && begins_with_sign(*(*binary)->left);
  return false;
}

}  // namespace

/// `place`: how tightly the expression must hold together where it stands; in an exponent, fractions lie on the line.
class Formula::Visitor {
 public:
  Visitor(Formula const& formula, bool in_exponent) : formula_(formula), to_(formula.to_), in_exponent_(in_exponent) {}

  std::string operator()(ast::Expression const& expression, OperatorBinding place) const {
    std::string const written = std::visit([&](auto const& node) { return (*this)(node); }, expression.node);
    return needs_fence(expression, place) ? to_.fenced(Fence::parentheses, written) : written;
  }

  std::string operator()(ast::Number const& number) const {
    std::string const digits = formula_.number(number.value);
    return number.unit ? to_.row({digits, to_.thin_space(), formula_.unit(*number.unit)}) : digits;
  }
  std::string operator()(ast::Text const& text) const { return to_.quoted(text.value); }
  std::string operator()(ast::Reference const& reference) const { return formula_(reference); }
  std::string operator()(ast::Box<ast::Unary> const& unary) const {
    if (unary->symbol == "not") return to_.row({to_.sign(Sign::negation), (*this)(*unary->operand, OperatorBinding::negation)});
    ast::Expression const& operand = *unary->operand;
    bool const fence = begins_with_sign(operand) && sysid::binding(operand) >= OperatorBinding::sign;
    return to_.row({to_.sign(Sign::negative), fence ? to_.fenced(Fence::parentheses, (*this)(operand, OperatorBinding::conditional))
                                                    : (*this)(operand, OperatorBinding::sign)});
  }
  std::string operator()(ast::Box<ast::Binary> const& binary) const {
    ast::Expression const &left = *binary->left, &right = *binary->right;
    if (binary->symbol == "^")
      return to_.raised((*this)(left, OperatorBinding::primary), Visitor(formula_, true)(right, OperatorBinding::conditional));
    if (binary->symbol == "/" && !in_exponent_)
      return to_.fraction((*this)(left, OperatorBinding::conditional), (*this)(right, OperatorBinding::conditional));
    OperatorRow const& row = operator_row(binary->symbol);
    std::string const before = (*this)(left, row.left);
    bool const fence = begins_with_sign(right) && sysid::binding(right) >= row.right;
    std::string const after =
        fence ? to_.fenced(Fence::parentheses, (*this)(right, OperatorBinding::conditional)) : (*this)(right, row.right);
    if (binary->symbol == "/") return to_.row({before, to_.quoted("/"), after});
    if (binary->symbol != "*") return to_.row({before, to_.sign(sign_of(binary->symbol)), after});
    return to_.row({before, to_.sign(begins_with_digit(right) ? Sign::times : Sign::invisible), after});
  }
  std::string operator()(ast::Box<ast::Call> const& call) const { return formula_.call(*call); }
  std::string operator()(ast::Box<ast::Conditional> const& conditional) const {
    std::vector<std::pair<std::string, std::string>> branches;
    ast::Conditional const* at = &*conditional;
    while (true) {
      branches.emplace_back(formula_(*at->then), formula_(*at->condition));
      auto const* further = std::get_if<ast::Box<ast::Conditional>>(&at->otherwise->node);
      if (further == nullptr) break;
      at = &**further;
    }
    branches.emplace_back(formula_(*at->otherwise), "");
    return to_.cases(branches);
  }
  std::string operator()(ast::Box<ast::List> const& list) const {
    std::vector<std::string> pieces;
    for (ast::Expression const& item : list->items) pieces.push_back(formula_(item));
    return to_.fenced(Fence::parentheses, formula_.list(pieces));
  }

 private:
  bool needs_fence(ast::Expression const& expression, OperatorBinding place) const {
    if (place == OperatorBinding::conditional) return false;
    auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node);
    bool const fraction = binary != nullptr && (*binary)->symbol == "/" && !in_exponent_;
    // A bar holds its fraction together, but not under a power; digits times a power of ten, and units, are products.
    if (fraction) return place >= OperatorBinding::power;
    auto const* number = std::get_if<ast::Number>(&expression.node);
    if (number != nullptr && place >= OperatorBinding::power)
      return number->unit.has_value() || std::signbit(number->value) || number_text(number->value).find('e') != std::string::npos;
    auto const* reference = std::get_if<ast::Reference>(&expression.node);
    if (reference != nullptr && place >= OperatorBinding::power) return reference->primes > 3;
    if (auto const* call = std::get_if<ast::Box<ast::Call>>(&expression.node))
      return place >= OperatorBinding::power ? !is_absolute(**call) : is_cases(**call);
    return sysid::binding(expression) < place;
  }
  /// Bars have their own ends; f(x) squared would read as f of x squared, and a root's line would seem to cover the power.
  static bool is_absolute(ast::Call const& call) { return call.function.text == "abs" && only_argument(call) != nullptr; }

  Formula const& formula_;
  Notation const& to_;
  bool in_exponent_;
};

std::string Formula::operator()(ast::Expression const& expression) const {
  return Visitor(*this, false)(expression, OperatorBinding::conditional);
}

std::string Formula::operator()(ast::Reference const& reference) const {
  TypesetSymbol const printed = symbols_(reference.name.text);
  std::string out = to_.letter(printed.base);
  if (reference.primes > 0 && reference.primes <= 3) out = to_.dotted(out, reference.primes);
  std::vector<std::string> indices;
  for (std::string const& index : printed.indices) {
    bool const digits = index.find_first_not_of("0123456789") == std::string::npos;
    indices.push_back(digits                                          ? to_.digits(index)
                      : text_width(index) == 1 || greek_letter(index) ? to_.letter(index)
                                                                      : to_.word(index));
  }
  for (ast::Expression const& index : reference.index) indices.push_back((*this)(index));
  if (!indices.empty()) out = to_.lowered(out, list(indices));
  if (reference.primes > 3) out = to_.raised(out, to_.fenced(Fence::parentheses, to_.digits(std::to_string(reference.primes))));
  return out;
}

std::string Formula::name(std::string_view name) const {
  ast::Reference reference;
  reference.name.text = std::string(name);
  return (*this)(reference);
}

std::string Formula::call(ast::Call const& call) const {
  std::string const& function = call.function.text;
  ast::Expression const* inside = only_argument(call);
  if (function == "sqrt" && inside != nullptr) return to_.root((*this)(*inside));
  if (function == "abs" && inside != nullptr) return to_.fenced(Fence::bars, (*this)(*inside));
  if (function == "lgamma" && inside != nullptr)
    return to_.row({to_.word("ln"),
                    to_.fenced(Fence::bars, to_.row({to_.letter("Gamma"), to_.fenced(Fence::parentheses, (*this)(*inside))}))});
  if (function == "log10" && inside != nullptr)
    return to_.row({to_.lowered(to_.word("log"), to_.digits("10")), to_.fenced(Fence::parentheses, (*this)(*inside))});
  if (is_cases(call)) {
    std::vector<std::pair<std::string, std::string>> branches;
    std::size_t i = 0;
    for (; i + 1 < call.arguments.size(); i += 2)
      branches.emplace_back((*this)(call.arguments[i + 1].value), (*this)(call.arguments[i].value));
    if (i < call.arguments.size()) branches.emplace_back((*this)(call.arguments[i].value), "");
    return to_.cases(branches);
  }
  std::string const head =
      text_width(function) == 1 || greek_letter(function) != nullptr ? name(function) : to_.word(printed_function(function));
  return to_.row({head, to_.fenced(Fence::parentheses, arguments(call.arguments))});
}

std::string Formula::distribution(ast::Call const& call) const {
  std::string const& function = call.function.text;
  if (function == "gp")  // of mean zero
    return to_.row({to_.calligraphic("GP"), to_.fenced(Fence::parentheses, arguments(call.arguments))});
  bool const normal = function == "normal" && call.arguments.size() == 2 && !call.arguments.front().name;
  if (normal) {
    // Bishop's N(mean, variance), whatever the scale is given by.
    Visitor const visit(*this, false);
    std::string variance;
    if (ast::Expression const* sd = named(call, "sd")) variance = to_.raised(visit(*sd, OperatorBinding::primary), to_.digits("2"));
    if (ast::Expression const* given = named(call, "variance")) variance = (*this)(*given);
    if (ast::Expression const* precision = named(call, "precision"))
      variance = to_.raised(visit(*precision, OperatorBinding::primary), to_.row({to_.sign(Sign::negative), to_.digits("1")}));
    if (!variance.empty())
      return to_.row({to_.calligraphic("N"),
                      to_.fenced(Fence::parentheses, list({(*this)(call.arguments.front().value), std::move(variance)}))});
  }
  return to_.row({to_.word(camel_case(function)), to_.fenced(Fence::parentheses, arguments(call.arguments))});
}

std::string Formula::unit(ast::UnitExpression const& unit) const {
  std::vector<std::string> pieces;
  for (ast::UnitFactor const& factor : unit.factors) {
    if (factor.reciprocal)
      pieces.push_back(pieces.empty() ? to_.row({to_.digits("1"), to_.quoted("/")}) : to_.quoted("/"));
    else if (!pieces.empty())
      pieces.push_back(to_.thin_space());
    auto const* atom = std::get_if<ast::Name>(&factor.base);
    std::string base = atom == nullptr
                           ? to_.fenced(Fence::parentheses, this->unit(*std::get<ast::Box<ast::UnitExpression>>(factor.base)))
                       : atom->text == "1" ? to_.digits("1")
                                           : to_.word(atom->text);
    pieces.push_back(factor.exponent ? to_.raised(base, Visitor(*this, true)(**factor.exponent, OperatorBinding::conditional))
                                     : base);
  }
  return pieces.empty() ? std::string() : to_.row(pieces);
}

std::string Formula::joined(std::string const& left, Sign sign, std::string const& right) const {
  return to_.row({left, to_.sign(sign), right});
}

std::string Formula::number(double value) const {
  std::string const text = number_text(std::fabs(value));
  std::vector<std::string> pieces;
  if (std::signbit(value)) pieces.push_back(to_.sign(Sign::negative));
  if (std::size_t const e = text.find('e'); e != std::string::npos) {
    std::string const mantissa = text.substr(0, e);
    std::string digits = text.substr(e + 1);
    bool const below_one = digits.front() == '-';
    digits.erase(0, std::min(digits.find_first_not_of("+-0"), digits.size() - 1));
    if (mantissa != "1") {
      pieces.push_back(to_.digits(mantissa));
      pieces.push_back(to_.sign(Sign::times));
    }
    std::string const power = to_.digits(digits);
    pieces.push_back(to_.raised(to_.digits("10"), below_one ? to_.row({to_.sign(Sign::negative), power}) : power));
  } else {
    pieces.push_back(to_.digits(text));
  }
  return to_.row(pieces);
}

std::string Formula::arguments(std::vector<ast::Argument> const& arguments) const {
  std::vector<std::string> pieces;
  for (ast::Argument const& argument : arguments)
    pieces.push_back(argument.name ? joined(to_.word(argument.name->text), Sign::equal, (*this)(argument.value))
                                   : (*this)(argument.value));
  return list(pieces);
}

std::string Formula::list(std::vector<std::string> const& pieces) const {
  std::vector<std::string> separated;
  for (std::string const& piece : pieces) {
    if (!separated.empty()) separated.push_back(to_.sign(Sign::comma));
    separated.push_back(piece);
  }
  return separated.empty() ? to_.row({std::string()}) : to_.row(separated);
}

}  // namespace sysid
