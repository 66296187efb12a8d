// Precedence, association, literals, calls and units.
#include <fmt/format.h>

#include "parsing.hpp"

using namespace sysid;
using test::parsed_expression;

namespace {

/// The tree in prefix form: `a + b*c` is "(+ a (* b c))".
std::string shape(ast::Expression const& expression);

struct Shape {
  std::string operator()(ast::Number const& number) const {
    return fmt::format("{}{}", number.value, number.unit ? "[" + unparse(*number.unit) + "]" : "");
  }
  std::string operator()(ast::Text const& text) const { return "'" + text.value + "'"; }
  std::string operator()(ast::Reference const& reference) const {
    return reference.name.text + std::string(static_cast<std::size_t>(reference.primes), '\'');
  }
  std::string operator()(ast::Box<ast::Unary> const& unary) const {
    return fmt::format("({} {})", unary->symbol, shape(*unary->operand));
  }
  std::string operator()(ast::Box<ast::Binary> const& binary) const {
    return fmt::format("({} {} {})", binary->symbol, shape(*binary->left), shape(*binary->right));
  }
  std::string operator()(ast::Box<ast::Call> const& call) const {
    std::string out = "(" + call->function.text;
    for (ast::Argument const& argument : call->arguments)
      out += fmt::format(" {}{}", argument.name ? argument.name->text + ":" : "", shape(argument.value));
    return out + ")";
  }
  std::string operator()(ast::Box<ast::Conditional> const& conditional) const {
    return fmt::format("(if {} {} {})", shape(*conditional->condition), shape(*conditional->then), shape(*conditional->otherwise));
  }
  std::string operator()(ast::Box<ast::List> const& list) const {
    std::string out = "{";
    for (ast::Expression const& item : list->items) out += (out.size() > 1 ? " " : "") + shape(item);
    return out + "}";
  }
};
std::string shape(ast::Expression const& expression) { return std::visit(Shape{}, expression.node); }
std::string shape(std::string const& text) { return shape(parsed_expression(text)); }

ast::UnitExpression unit(std::string const& text) {
  return *std::get<ast::Number>(parsed_expression("1 [" + text + "]").node).unit;
}
std::string name_of(ast::UnitFactor const& factor) { return std::get<ast::Name>(factor.base).text; }

}  // namespace

TEST_CASE("operators bind from or, and, not, comparison, sum, product, sign to power") {
  CHECK(shape("a or b and c") == "(or a (and b c))");
  CHECK(shape("not a and b") == "(and (not a) b)");
  CHECK(shape("not a < b") == "(not (< a b))");
  CHECK(shape("not not a") == "(not (not a))");
  CHECK(shape("a + 1 >= b*2") == "(>= (+ a 1) (* b 2))");
  CHECK(shape("a + b*c - d/e") == "(- (+ a (* b c)) (/ d e))");
  CHECK(shape("-a*b") == "(* (- a) b)");
  CHECK(shape("-a^2") == "(- (^ a 2))");
  CHECK(shape("a*-b") == "(* a (- b))");
  CHECK(shape("a - -b") == "(- a (- b))");
}

TEST_CASE("sums and products associate to the left, powers to the right") {
  CHECK(shape("a - b - c") == "(- (- a b) c)");
  CHECK(shape("a/b/c*d") == "(* (/ (/ a b) c) d)");
  CHECK(shape("a^b^c") == "(^ a (^ b c))");
  CHECK(shape("2^-1") == "(^ 2 (- 1))");
  CHECK(shape("2^-x^2") == "(^ 2 (- (^ x 2)))");
  CHECK(shape("a or b or c") == "(or (or a b) c)");
}

TEST_CASE("parentheses group, and with a comma make a list") {
  CHECK(shape("(a + b)*c") == "(* (+ a b) c)");
  CHECK(shape("((a))") == "a");
  CHECK(shape("(a, b + 1, c)") == "{a (+ b 1) c}");
  CHECK(shape("(a, (b, c))") == "{a {b c}}");
}

TEST_CASE("all six comparisons are read") {
  for (std::string const symbol : {"<", "<=", ">", ">=", "==", "!="}) CHECK(shape("a" + symbol + "b") == "(" + symbol + " a b)");
}

TEST_CASE("a conditional reaches as far as it can") {
  CHECK(shape("if a < b then c else d + 1") == "(if (< a b) c (+ d 1))");
  CHECK(shape("if a then b else if c then d else e") == "(if a b (if c d e))");
  CHECK(shape("1 + (if a then b else c)") == "(+ 1 (if a b c))");
}

TEST_CASE("calls take positional and named arguments") {
  CHECK(shape("f()") == "(f)");
  CHECK(shape("f (a, sd = b*2)") == "(f a sd:(* b 2))");
  CHECK(shape("f(a == b)") == "(f (== a b))");
  CHECK(shape("f(if a then b else c, \"text\")") == "(f (if a b c) 'text')");
}

TEST_CASE("primes follow their name and survive operators") {
  CHECK(shape("y''*y'") == "(* y'' y')");
  CHECK(shape("abs(y')^2") == "(^ (abs y') 2)");
}

TEST_CASE("numbers are correctly rounded and need digits on both sides of the dot") {
  CHECK(std::get<ast::Number>(parsed_expression("0.1").node).value == 0.1);
  CHECK(std::get<ast::Number>(parsed_expression("1e-4").node).value == 1e-4);
  CHECK(std::get<ast::Number>(parsed_expression("6.02214076E+23").node).value == 6.02214076e23);
  CHECK(std::get<ast::Number>(parsed_expression("179769313486231570000000000000000000000").node).value == 1.7976931348623157e38);
  CHECK(shape("inf") == "inf");
  CHECK(std::holds_alternative<ast::Reference>(parsed_expression("inf").node));
  CHECK(std::holds_alternative<ast::Reference>(parsed_expression("nano").node));
}

TEST_CASE("texts resolve their escapes") {
  CHECK(std::get<ast::Text>(parsed_expression(R"("a \"b\" \\ \n # no comment")").node).value == "a \"b\" \\ \n # no comment");
}

TEST_CASE("names hold letters of any alphabet") {
  CHECK(shape("σ_ε*ω0 + Größe") == "(+ (* σ_ε ω0) Größe)");
  CHECK(shape("3 [µm]") == "3[µm]");
}

TEST_CASE("a unit follows a number only") {
  CHECK(shape("9.81 [m/s^2]*t") == "(* 9.81[m/s^2] t)");
  CHECK(shape("2 [percent] + 3 [%]") == "(+ 2[percent] 3[%])");
}

TEST_CASE("a slash in a unit divides by the next factor only") {
  ast::UnitExpression const newton_per_metre_second = unit("N/m s");
  REQUIRE(newton_per_metre_second.factors.size() == 3);
  CHECK_FALSE(newton_per_metre_second.factors[0].reciprocal);
  CHECK(newton_per_metre_second.factors[1].reciprocal);
  CHECK_FALSE(newton_per_metre_second.factors[2].reciprocal);
  CHECK(unit("N/m s") == unit("N/m*s"));
  CHECK(unit("N/m s") == unit("N / m  s"));
  CHECK_FALSE(unit("N/m s") == unit("N/(m s)"));
}

TEST_CASE("a unit may be a group, a one, a sign for none, or a percent") {
  ast::UnitExpression const grouped = unit("N/(m s)^2");
  REQUIRE(grouped.factors.size() == 2);
  auto const& group = *std::get<ast::Box<ast::UnitExpression>>(grouped.factors[1].base);
  CHECK(group.factors.size() == 2);
  CHECK(shape(**grouped.factors[1].exponent) == "2");
  CHECK(name_of(unit("1/m^2").factors[0]) == "1");
  REQUIRE(unit("-").factors.size() == 1);
  CHECK(name_of(unit("-").factors[0]) == "-");
  CHECK(name_of(unit("%").factors[0]) == "%");
}

TEST_CASE("exponents of units are numbers, names or expressions in parentheses") {
  CHECK(shape(**unit("s^-2").factors[0].exponent) == "(- 2)");
  CHECK(shape(**unit("s^0.5").factors[0].exponent) == "0.5");
  CHECK(shape(**unit("N^(1-n)/m").factors[0].exponent) == "(- 1 n)");
  CHECK(shape(**unit("N^n").factors[0].exponent) == "n");
  CHECK(unit("N^n (m s)").factors.size() == 2);
}
