// The checker's wording about calls: functions of other languages with their arguments as they are written here.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "check/message/error_words.hpp"
#include "core/text/words.hpp"
#include "distribution/distribution.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym function_synonyms[] = {
    {"absolute", "abs"},   {"fabs", "abs"}, {"arccos", "acos"}, {"arcsin", "asin"}, {"arctan", "atan"},
    {"heaviside", "step"}, {"ln", "log"},   {"sgn", "sign"},    {"signum", "sign"}, {"squareroot", "sqrt"},
};

/// A function that is written as an expression here. In `ours`, {a}, {b} and {c} are the arguments, {A} and {B} the same as
/// operands of `*` and `^`.
struct ForeignFunction {
  std::string_view foreign;  // in small letters
  std::size_t arguments;
  std::string_view ours, why;
};

constexpr std::string_view with_power = "powers are written with ^",
                           by_condition = "a value that depends on a condition is written", no_such = "write";
constexpr ForeignFunction foreign_functions[] = {
    {"pow", 2, "{A}^{B}", with_power},
    {"power", 2, "{A}^{B}", with_power},
    {"cube", 1, "{A}^3", with_power},
    {"cbrt", 1, "(sign({a})*abs({a})^(1/3))", no_such},
    {"exp2", 1, "2^{A}", with_power},
    {"exp10", 1, "10^{A}", with_power},
    {"log2", 1, "(log({a})/log(2))", no_such},
    {"mod", 2, "({a} - {B}*floor({A}/{B}))", no_such},
    {"fmod", 2, "({a} - {B}*floor({A}/{B}))", no_such},
    {"rem", 2, "({a} - {B}*floor({A}/{B}))", no_such},
    {"modulo", 2, "({a} - {B}*floor({A}/{B}))", no_such},
    {"ceil", 1, "(-floor(-{A}))", no_such},
    {"ceiling", 1, "(-floor(-{A}))", no_such},
    {"round", 1, "floor({a} + 0.5)", no_such},
    {"sec", 1, "(1/cos({a}))", no_such},
    {"csc", 1, "(1/sin({a}))", no_such},
    {"cot", 1, "(1/tan({a}))", no_such},
    {"sech", 1, "(1/cosh({a}))", no_such},
    {"asinh", 1, "log({a} + sqrt({A}^2 + 1))", no_such},
    {"acosh", 1, "log({a} + sqrt({A}^2 - 1))", no_such},
    {"atanh", 1, "(0.5*log((1 + {A})/(1 - {A})))", no_such},
    {"sigmoid", 1, "(1/(1 + exp(-{A})))", no_such},
    {"logistic", 1, "(1/(1 + exp(-{A})))", no_such},
    {"expit", 1, "(1/(1 + exp(-{A})))", no_such},
    {"relu", 1, "max({a}, 0)", no_such},
    {"sat", 1, "clamp({a}, -1, 1)", no_such},
    {"sat", 3, "clamp({a}, {b}, {c})", no_such},
    {"if", 3, "(if {a} then {b} else {c})", by_condition},
    {"iif", 3, "(if {a} then {b} else {c})", by_condition},
    {"ifelse", 3, "(if {a} then {b} else {c})", by_condition},
    {"if_else", 3, "(if {a} then {b} else {c})", by_condition},
    {"where", 3, "(if {a} then {b} else {c})", by_condition},
    {"cond", 3, "(if {a} then {b} else {c})", by_condition},
};

// Functions of degrees, and of what they are of radians.
constexpr Synonym degree_functions[] = {{"sind", "sin"},   {"cosd", "cos"},   {"tand", "tan"},     {"asind", "asin"},
                                        {"acosd", "acos"}, {"atand", "atan"}, {"atan2d", "atan2"}, {"sindeg", "sin"},
                                        {"cosdeg", "cos"}, {"tandeg", "tan"}};
constexpr std::string_view to_radians[] = {"deg2rad", "radians", "d2r", "torad", "degtorad"};
constexpr std::string_view to_degrees[] = {"rad2deg", "degrees", "r2d", "todeg", "radtodeg"};

bool is_bare_number(ast::Expression const& tree) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node))
    return (*unary)->symbol == "-" && is_bare_number(*(*unary)->operand);
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && !number->unit;
}

/// In parentheses where an operator beside it would take it apart.
std::string as_operand(ast::Expression const& tree) {
  bool const negative = std::holds_alternative<ast::Box<ast::Unary>>(tree.node);
  bool const whole = (is_bare_number(tree) && !negative) || std::holds_alternative<ast::Reference>(tree.node) ||
                     std::holds_alternative<ast::Box<ast::Call>>(tree.node);
  return whole ? unparse(tree) : fmt::format("({})", unparse(tree));
}

/// With the arguments that it is given, or with letters for them.
std::string in_terms_of_arguments(ForeignFunction const& row, ast::Call const& call) {
  std::array<std::string, 3> text{"a", "b", "c"}, operand = text;
  if (call.arguments.size() == row.arguments)
    for (std::size_t i = 0; i < row.arguments; ++i) {
      text[i] = unparse(call.arguments[i].value);
      operand[i] = as_operand(call.arguments[i].value);
    }
  return fmt::format(fmt::runtime(row.ours), fmt::arg("a", text[0]), fmt::arg("b", text[1]), fmt::arg("c", text[2]),
                     fmt::arg("A", operand[0]), fmt::arg("B", operand[1]));
}

/// `30 [deg]`; of a name, which may be declared in degrees, its product with a degree.
std::string in_degrees(ast::Expression const& tree) {
  return is_bare_number(tree) ? fmt::format("{} [deg]", unparse(tree)) : fmt::format("{}*1 [deg]", as_operand(tree));
}

/// Angles carry their unit; empty for other calls.
std::string of_angle(ast::Call const& call, std::string const& name) {
  bool const given = !call.arguments.empty();
  std::string const argument = given ? unparse(call.arguments.front().value) : "x";
  bool const number = given && is_bare_number(call.arguments.front().value);
  std::string const degrees = given ? in_degrees(call.arguments.front().value) : "30 [deg]";
  if (std::find(std::begin(to_radians), std::end(to_radians), name) != std::end(to_radians))
    return number
               ? fmt::format("an angle carries its unit: write `{}`", degrees)
               : fmt::format("an angle carries its unit: write `{0}` where it is declared in [deg], else `{1}`", argument, degrees);
  if (std::find(std::begin(to_degrees), std::end(to_degrees), name) != std::end(to_degrees))
    return fmt::format("an angle carries its unit: write `{}`; its number of degrees is `{}/1 [deg]`", argument,
                       given ? as_operand(call.arguments.front().value) : "x");
  for (Synonym const& each : degree_functions) {
    if (each.foreign != name) continue;
    if (name.front() == 'a') {
      std::string all;
      for (ast::Argument const& one : call.arguments) all += (all.empty() ? "" : ", ") + unparse(one.value);
      return fmt::format("an angle carries its unit: write `{0}({1})`; its number of degrees is `{0}({1})/1 [deg]`", each.ours,
                         all);
    }
    return number ? fmt::format("an angle carries its unit: write `{}({})`", each.ours, degrees)
                  : fmt::format("an angle carries its unit: write `{0}({1})` where it is declared in [deg], else `{0}({2})`",
                                each.ours, argument, degrees);
  }
  return {};
}

std::string no_delay(std::string const& delayed) {
  return fmt::format(
      "there are no delays in continuous time; a first-order lag with the time constant T is a state with an equation: `state "
      "late` "
      "and `late' = ({} - late)/T`",
      delayed);
}

constexpr char const* over_the_record =
    "a quantity of a model has a value at each time: compute one over the record from the table of a prediction";
/// What is written here that functions with too few arguments are in other programs.
constexpr Synonym fewer_arguments[] = {
    {"lag", "write `lag(y, 1)` for the sample before"}, {"max", over_the_record}, {"min", over_the_record}};

/// What has no function here, and how it is modelled; empty for other calls.
std::string of_model(ast::Call const& call, std::string const& name) {
  std::string const argument = call.arguments.empty() ? "y" : unparse(call.arguments.front().value);
  for (std::string_view const each : {"integral", "integrate", "cumtrapz", "trapz", "cumsum"})
    if (name == each) return fmt::format("an integral is a state with an equation: `state z` and `z' = {}`", argument);
  for (std::string_view const each : {"delay", "delayed", "dead_time", "deadtime", "transport_delay"})
    if (name == each)
      return fmt::format("{}; in discrete time write `lag({}, 1)` for the sample before", no_delay(argument), argument);
  for (std::string_view const each : {"prev", "previous", "pre", "last", "unit_delay"})
    if (name == each) return fmt::format("in discrete time the sample before is written `lag({}, 1)`", argument);
  for (std::string_view const each : {"mean", "average", "avg", "rms", "std", "var", "variance", "median"})
    if (name == each) return over_the_record;
  for (std::string_view const each : {"randn", "rand", "random", "noise", "normrnd", "white_noise"})
    if (name == each)
      return "noise of a measurement is written after `observe`, `observe d ~ normal(y, sd = sigma)`; an unknown force is a "
             "`disturbance`";
  return {};
}

/// `Parameter(2.5, min = 0.5, max = 10)` of other programs.
std::string with_prior(ast::Call const& call) {
  std::string lower = "0.1", upper = "10";
  for (ast::Argument const& each : call.arguments) {
    if (each.name && (each.name->text == "min" || each.name->text == "lower" || each.name->text == "lb"))
      lower = unparse(each.value);
    if (each.name && (each.name->text == "max" || each.name->text == "upper" || each.name->text == "ub"))
      upper = unparse(each.value);
  }
  return fmt::format("a parameter is declared with its prior: `parameter NAME ~ uniform({}, {})`", lower, upper);
}

/// `y(t)`, `y(t - 0.01)`, `y(0)`.
std::string of_quantity(ast::Call const& call) {
  std::string const& name = call.function.text;
  std::string const general = fmt::format(
      "multiplication is written with *: `{0}*(...)`; a quantity is written without its time, `{0}`, and an initial value as "
      "`initial {0} = ...`",
      name);
  // `... = x (2)`: more often the number of an equation than a factor.
  if (call.arguments.size() == 1 && is_bare_number(call.arguments.front().value))
    return fmt::format("remove `({})` if it is the number of the equation; {}", unparse(call.arguments.front().value), general);
  return call.arguments.size() != 1
             ? general
             : fmt::format("multiplication is written with *: `{0}*({1})`; a quantity is written without its time, `{0}`", name,
                           unparse(call.arguments.front().value));
}

/// `t`, `time`, whatever the model has declared.
bool is_time(ast::Expression const& tree) {
  auto const* reference = std::get_if<ast::Reference>(&tree.node);
  return reference != nullptr && (reference->name.text == "t" || reference->name.text == "time");
}

}  // namespace

std::optional<Diagnostic> quantity_at_time(ast::Call const& call) {
  if (call.arguments.size() != 1 || call.arguments.front().name) return std::nullopt;
  std::string const& name = call.function.text;
  ast::Expression const& argument = call.arguments.front().value;
  auto const* shift = std::get_if<ast::Box<ast::Binary>>(&argument.node);
  bool const shifted = shift != nullptr && ((*shift)->symbol == "-" || (*shift)->symbol == "+") && is_time(*(*shift)->left);
  if (!shifted && !is_time(argument)) return std::nullopt;
  return about({name}, error("E2003", call.function.span, fmt::format("`{}` is a quantity, not a function", name),
                             shifted ? no_delay(name) : fmt::format("a quantity is written without its time, `{}`", name)));
}

Diagnostic unknown_function(ast::Call const& call, Names const& known, bool is_quantity) {
  ast::Name const& name = call.function;
  auto const refused = [&](std::string message, std::string help, std::string kind = {}) {
    return about({name.text}, error("E2003", name.span, std::move(message), std::move(help)), std::move(kind));
  };
  if (is_quantity) return refused(fmt::format("`{}` is a quantity, not a function", name.text), of_quantity(call));
  std::string const message = fmt::format("there is no function `{}`", name.text), plain = in_small_letters(name.text);
  if (find_distribution(plain) != nullptr)
    return refused(fmt::format("`{}` is a distribution, not a function", name.text),
                   fmt::format("a prior is written with `~`: `parameter k ~ {}(...)`", plain));
  for (std::string_view const derivative :
       {"der", "diff", "d", "ddt", "dt", "derivative", "D", "dot", "ddot", "Dt", "dydt", "dxdt"})
    if (name.text == derivative) return refused(message, "a derivative is written with primes: `y'`, `y''`", "function");
  constexpr Synonym of_arrays[] = {{"diag", "diagonal"}, {"eye", "identity"}, {"trans", "transpose"}};
  for (Synonym const& each : of_arrays)
    if (name.text == each.foreign) return refused(message, fmt::format("did you mean `{}`?", each.ours), "function");
  ForeignFunction const* written = nullptr;
  for (ForeignFunction const& each : foreign_functions)
    if (each.foreign == plain && (written == nullptr || each.arguments == call.arguments.size())) written = &each;
  if (written != nullptr)
    return refused(
        message,
        fmt::format("{}{} `{}`", written->why, written->why == with_power ? ":" : "", in_terms_of_arguments(*written, call)),
        "function");
  if (plain == "parameter" || plain == "param" || plain == "parameters") return refused(message, with_prior(call), "function");
  if (std::string const angle = of_angle(call, plain); !angle.empty()) return refused(message, angle, "function");
  if (std::string const model = of_model(call, plain); !model.empty()) return refused(message, model, "function");
  auto const help = [&](std::string const& list) {
    if (name.text == "pi") return std::string("write `pi`: it is a number");
    return guess_or(function_synonyms, name.text, known, "define it: `function f(a, b) = ...`; built-in functions: " + list);
  };
  Diagnostic result = refused(message, help("sysid list functions"), "function");
  result.prompt_help = help("`list functions`");
  return result;
}

Diagnostic divided_power(ast::Binary const& power, ast::Expression const& divisor) {
  std::string const base = as_operand(*power.left), below = unparse(divisor);
  return error(
      "E2016", cover(power.left->span, divisor.span), fmt::format("`{0}^1/{1}` is `({0}^1)/{1}`", base, below),
      fmt::format("an exponent that is a quotient has parentheses: `{0}^(1/{1})`; otherwise write `{0}/{1}`", base, below));
}

Diagnostic argument_count(ast::Name const& function, std::size_t given, std::size_t least, std::size_t most) {
  std::string const wanted = least == most ? fmt::format("{}", least)
                             : most > 100  ? fmt::format("{} or more", least)
                                           : fmt::format("{} to {}", least, most);
  std::string help = "give each argument once, separated by commas";
  for (Synonym const& each : fewer_arguments)
    if (function.text == each.foreign && given < least) help = each.ours;
  return about({function.text},
               error("E2004", function.span,
                     fmt::format("`{}` takes {} argument{}, not {}", function.text, wanted, wanted == "1" ? "" : "s", given),
                     std::move(help)));
}

Diagnostic piecewise_without_otherwise(ast::Call const& call) {
  return about({call.function.text},
               error("E2004", call.span, fmt::format("`{}` has no value where no condition holds", call.function.text),
                     "write condition, value, condition, value, ..., and last the value for all other cases"));
}

Diagnostic named_argument_of_function(ast::Name const& argument, std::string const& function) {
  return about({function}, error("E2005", argument.span, fmt::format("arguments of the function `{}` have no names", function),
                                 fmt::format("remove `{} =`", argument.text)));
}

}  // namespace sysid::errors
