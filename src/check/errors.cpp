// The checker's wording. Messages are lower case without a full stop; `help` says what to do.
#include "check/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

#include "distribution/distribution.hpp"

namespace sysid::errors {
namespace {

Diagnostic error(std::string code, Span span, std::string message, std::string help = {}, std::string label = {}) {
  return {Severity::error, std::move(code), std::move(message), Label{span, std::move(label)}, {}, std::move(help)};
}

Diagnostic conflict(std::string code, Span span, std::string label, Span other, std::string other_label, std::string message,
                    std::string help = {}) {
  Diagnostic result = error(std::move(code), span, std::move(message), std::move(help), std::move(label));
  result.secondary.push_back({other, std::move(other_label)});
  return result;
}

std::string quoted(Names const& names, std::string const& last = "and") {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i != 0) text += i + 1 == names.size() ? fmt::format(" {} ", last) : ", ";
    text += fmt::format("`{}`", names[i]);
  }
  return text;
}

// "did you mean ...", else the given fallback.
std::string guess_or(std::string const& text, Names const& known, std::string fallback) {
  std::string guess = did_you_mean(text, known);
  return guess.empty() ? std::move(fallback) : guess;
}

std::string choose(Names const& known, std::string const& what) {
  if (known.empty()) return fmt::format("there is no {} here", what);
  return fmt::format("there {} {}", known.size() == 1 ? "is" : "are", quoted(known));
}

// "in [N/m]", "a pure number".
std::string measure(Unit const& unit) {
  if (unit.dimensionless()) return "a pure number";
  return fmt::format("in [{}]", unit.text.empty() ? format_dimension(unit.dimension) : unit.text);
}

std::string primed(std::string const& name, int primes) { return name + std::string(static_cast<std::size_t>(primes), '\''); }
std::string primed(ast::Reference const& reference) { return primed(reference.name.text, reference.primes); }

// Words of other languages and of papers, with ours.
struct Synonym {
  std::string_view foreign, ours;
};
constexpr Synonym function_synonyms[] = {
    {"absolute", "abs"},   {"fabs", "abs"}, {"arccos", "acos"}, {"arcsin", "asin"}, {"arctan", "atan"},
    {"heaviside", "step"}, {"ln", "log"},   {"sgn", "sign"},    {"signum", "sign"}, {"squareroot", "sqrt"},
};
constexpr Synonym distribution_synonyms[] = {
    {"gaussian", "normal"},        {"gauss", "normal"},         {"loguniform", "log_uniform"}, {"reciprocal", "log_uniform"},
    {"lognormal", "log_normal"},   {"jeffreys", "log_uniform"}, {"invgamma", "inverse_gamma"}, {"halfnormal", "half_normal"},
    {"halfcauchy", "half_cauchy"}, {"t", "student_t"},          {"cauchy", "student_t"},
};
// Help in place of a guess.
constexpr Synonym name_synonyms[] = {
    {"time", "time is declared where it is used: `time t [s]`"},
    {"t", "time is declared where it is used: `time t [s]`"},
    {"π", "write `pi`"},
    {"ẏ", "a derivative is written with primes: `y'`"},
    {"ÿ", "a derivative is written with primes: `y''`"},
    {"ẋ", "a derivative is written with primes: `x'`"},
    {"ẍ", "a derivative is written with primes: `x''`"},
};
constexpr Synonym argument_synonyms[] = {
    {"sigma", "sd"},
    {"std", "sd"},
    {"stdev", "sd"},
    {"stddev", "sd"},
    {"var", "variance"},
    {"mu", "mean"},
    {"tau", "precision"},
    {"min", "lower"},
    {"low", "lower"},
    {"max", "upper"},
    {"high", "upper"},
    {"nu", "degrees_of_freedom"},
    {"df", "degrees_of_freedom"},
};

// Our word for a foreign one, if it is among the known; whatever the capitals.
std::string synonym(std::span<Synonym const> table, std::string text, Names const& known) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (Synonym const& each : table)
    if (each.foreign == text && std::find(known.begin(), known.end(), each.ours) != known.end())
      return fmt::format("did you mean `{}`?", each.ours);
  return {};
}

// A synonym, else a near name, else the fallback.
std::string guess_or(std::span<Synonym const> table, std::string const& text, Names const& known, std::string fallback) {
  std::string guess = synonym(table, text, known);
  return guess.empty() ? guess_or(text, known, std::move(fallback)) : guess;
}

}  // namespace

Diagnostic unknown_name(ast::Name const& name, Names const& known) {
  for (Synonym const& each : name_synonyms)
    if (name.text == each.foreign)
      return error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text), std::string(each.ours));
  // ydot, dydt, dy of a y that there is.
  for (std::string const& each : known)
    for (char const* pattern : {"{}dot", "{}_dot", "d{}", "d{}dt", "{}ddot", "d2{}", "{}dotdot"})
      if (name.text == fmt::format(fmt::runtime(pattern), each))
        return error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
                     fmt::format("a derivative is written with primes: `{0}'`, `{0}''`", each));
  return error("E2001", name.span, fmt::format("`{}` is not declared in this model", name.text),
               guess_or(name.text, known, "declare it as state, input, parameter, constant or local definition (let)"));
}
Diagnostic duplicate_name(ast::Name const& name, Span first) {
  return conflict("E2002", name.span, "again here", first, "first declared here", fmt::format("`{}` is declared twice", name.text),
                  "rename one of the two, or delete it");
}
Diagnostic unknown_function(ast::Name const& name, Names const& known, bool is_quantity) {
  if (is_quantity)
    return error("E2003", name.span, fmt::format("`{}` is a quantity, not a function", name.text),
                 fmt::format("multiplication is written with *: `{}*(...)`", name.text));
  for (std::string_view const derivative : {"der", "diff", "d", "ddt", "dt", "derivative", "D"})
    if (name.text == derivative)
      return error("E2003", name.span, fmt::format("there is no function `{}`", name.text),
                   "a derivative is written with primes: `y'`, `y''`");
  if (find_distribution(name.text) != nullptr)
    return error("E2003", name.span, fmt::format("`{}` is a distribution, not a function", name.text),
                 fmt::format("a prior is written with `~`: `parameter k ~ {}(...)`", name.text));
  if (name.text == "pow" || name.text == "power")
    return error("E2003", name.span, fmt::format("there is no function `{}`", name.text), "powers are written with ^: `a^b`");
  return error(
      "E2003", name.span, fmt::format("there is no function `{}`", name.text),
      guess_or(function_synonyms, name.text, known, "define it: `function f(a, b) = ...`; built-in ones: sysid list functions"));
}
Diagnostic argument_count(ast::Name const& function, std::size_t given, std::size_t least, std::size_t most) {
  std::string const wanted = least == most ? fmt::format("{}", least)
                             : most > 100  ? fmt::format("{} or more", least)
                                           : fmt::format("{} to {}", least, most);
  return error("E2004", function.span,
               fmt::format("`{}` takes {} argument{}, here it has {}", function.text, wanted, wanted == "1" ? "" : "s", given),
               "give each argument once, separated by commas");
}
Diagnostic piecewise_without_otherwise(ast::Call const& call) {
  return error("E2004", call.span, fmt::format("`{}` has no value for when no condition holds", call.function.text),
               "its arguments are condition, value, condition, value, ..., and last the value otherwise");
}
Diagnostic named_argument_of_function(ast::Name const& argument, std::string const& function) {
  return error("E2005", argument.span, fmt::format("arguments of the function `{}` have no names", function),
               fmt::format("leave out `{} =`", argument.text));
}
Diagnostic definition_cycle(Span span, Names const& loop) {
  return error("E2006", span, fmt::format("this definition needs itself: {}", fmt::join(loop, " -> ")),
               "break the loop; a quantity with memory is a state with an equation");
}
Diagnostic primes_on(ast::Reference const& reference, std::string const& what) {
  return error("E2007", reference.span, fmt::format("`{}` is {}: it has no time derivative", reference.name.text, what),
               fmt::format("primes belong to states and inputs; declare `state {}` if it moves", reference.name.text));
}
Diagnostic beyond_highest(ast::Reference const& reference, int order) {
  return error(
      "E2007", reference.span,
      fmt::format("`{}` is beyond the highest derivative of `{}` in the equations", primed(reference), reference.name.text),
      fmt::format("the equations determine `{}`: write its time derivative out", primed(reference.name.text, order)));
}
Diagnostic second_input_derivative(ast::Reference const& reference) {
  return error("E2008", reference.span, fmt::format("`{}`: only the first derivative of an input is defined", primed(reference)),
               "bind the derivative as an input of its own");
}
Diagnostic not_a_number(Span span, std::string const& what) {
  return error("E2009", span, fmt::format("{} cannot stand in an expression", what), "an expression is made of numbers and names");
}
Diagnostic constant_needed(Span span, std::string const& what) {
  return error("E2010", span, fmt::format("{} must be a number known before the run", what),
               "use numbers, constants and functions of them only");
}
Diagnostic unknown_unit(ast::Name const& name) {
  if (name.text == "per") return error("E2011", name.span, "`per` is not a unit", "division is written with `/`: [N s/m]");
  return error(
      "E2011", name.span, fmt::format("`{}` is not a unit known here", name.text),
      guess_or(name.text, common_unit_names(), "units are those of UDUNITS-2 with SI prefixes: [N s/m], [mm], [1/m^2], [rad/s]"));
}
Diagnostic unit_exponent(Span span) {
  return error("E2012", span, "the exponent of a unit must be a fraction of small whole numbers",
               "for example [m^2], [N^(1/2)], [s^-1]");
}
Diagnostic list_here(Span span) {
  return error("E2013", span, "a list cannot stand in an expression", "parentheses with a comma make a list; remove the comma");
}
Diagnostic number_of_other_kind(Span span, std::string const& what, Unit const& given, Unit const& wanted) {
  return error("E2014", span, fmt::format("{} is {}, this is {}", what, measure(wanted), measure(given)),
               wanted.dimensionless() ? "leave out the unit" : "correct the unit, or leave it out");
}

Diagnostic unknown_distribution(ast::Name const& name, Names const& known) {
  return error("E2101", name.span, fmt::format("there is no distribution `{}`", name.text),
               guess_or(distribution_synonyms, name.text, known, fmt::format("distributions: {}", quoted(known))));
}
Diagnostic unknown_argument(ast::Name const& argument, std::string const& distribution, Names const& known) {
  return error("E2102", argument.span, fmt::format("`{}` has no argument `{}`", distribution, argument.text),
               guess_or(argument_synonyms, argument.text, known, fmt::format("its arguments are {}", quoted(known))));
}
Diagnostic argument_twice(Span second, Span first, std::string const& spelling, std::string const& other) {
  if (spelling == other)
    return conflict("E2104", second, "again here", first, "first given here", fmt::format("`{}` is given twice", spelling),
                    "keep one");
  return conflict("E2104", second, fmt::format("`{}`", spelling), first, fmt::format("`{}`", other),
                  fmt::format("`{}` and `{}` say the same thing twice", other, spelling),
                  "keep one: precision = 1/variance, variance = sd^2");
}
Diagnostic argument_missing(ast::Call const& call, Names const& spellings) {
  return error("E2105", call.span, fmt::format("`{}` needs {}", call.function.text, quoted(spellings, "or")),
               fmt::format("write for example `{} = ...`", spellings.front()));
}
Diagnostic must_be_named(Span span, std::string const& distribution, Names const& spellings) {
  return error("E2106", span, fmt::format("say which this is: {}", quoted(spellings, "or")),
               fmt::format("write `{}(..., {} = ...)`", distribution, spellings.front()));
}
Diagnostic too_many_arguments(Span span, std::string const& distribution, Names const& signature) {
  return error("E2107", span, fmt::format("`{}` has no further argument", distribution),
               signature.empty() ? "it takes none" : fmt::format("its arguments are {}", quoted(signature)));
}
Diagnostic not_a_noise(ast::Call const& call, Names const& known) {
  return error("E2108", call.function.span, fmt::format("`{}` cannot be the noise of a channel", call.function.text),
               fmt::format("use {}", quoted(known, "or")));
}
Diagnostic truncated_noise(ast::Call const& call) {
  return error("E2116", call.span, "the noise of a channel cannot be truncated",
               "leave out `lower` and `upper`; bound the parameters instead");
}
Diagnostic cannot_truncate(Span span, std::string const& distribution) {
  return error("E2109", span, fmt::format("`{}` cannot be truncated", distribution), "leave out `lower` and `upper`");
}
Diagnostic prior_reads(Span span, std::string const& parameter, std::string const& what) {
  return error("E2110", span, fmt::format("the prior of `{}` reads {}", parameter, what),
               "a prior may use numbers, constants and other parameters");
}
Diagnostic prior_cycle(Span span, Names const& loop) {
  return error("E2111", span, fmt::format("these priors need each other: {}", fmt::join(loop, " -> ")),
               "one of them must stand without the others");
}
Diagnostic bad_arguments(Span span, std::string const& distribution, std::string_view reason) {
  return error("E2112", span, fmt::format("these arguments of `{}` are impossible: {}", distribution, reason),
               "correct the numbers");
}
Diagnostic no_mass(Span span, std::string const& distribution) {
  return error("E2115", span, fmt::format("`{}` has no mass between its bounds", distribution),
               "widen `lower` and `upper`, or move the distribution");
}
Diagnostic unit_of_share(Span span, std::string const& distribution, std::string const& unit) {
  return error("E2117", span, fmt::format("`{}` is a distribution of pure numbers, here it should give [{}]", distribution, unit),
               fmt::format("multiply: a share with this prior, times a quantity in [{}]", unit));
}
Diagnostic unit_of_count(Span span, std::string const& distribution, std::string const& unit) {
  return error("E2118", span, fmt::format("`{}` counts, here it should give [{}]", distribution, unit),
               "a count is a pure number: divide the expression by the size of one item, and leave out the unit of the channel");
}
Diagnostic count_as_prior(ast::Call const& call) {
  return error("E2119", call.function.span,
               fmt::format("`{}` gives whole numbers: it is noise of a channel, not a prior", call.function.text),
               "use a continuous prior, such as gamma or log_normal");
}
Diagnostic noise_of_counts(Span span, std::string const& channel, std::string const& distribution) {
  return error("E6015", span, fmt::format("channel `{}` counts: noise in percent would not leave whole numbers", channel),
               fmt::format("write `noise = model`: the counts are then drawn from `{}`", distribution));
}
Diagnostic no_prior_or_value(ast::ParameterDeclaration const& parameter) {
  std::string const& name = parameter.name.name.text;
  return error("E2113", parameter.name.span, fmt::format("parameter `{}` has neither a prior nor a value", name),
               fmt::format("give a prior, `parameter {} ~ log_uniform(0.1, 10)`, or a value, `parameter {} = 1`", name, name));
}

Diagnostic state_without_equation(Span declaration, std::string const& state, std::string const& highest) {
  return error("E3001", declaration, fmt::format("state `{}` has no equation", state),
               fmt::format("write the equation that contains {}", highest));
}
Diagnostic algebraic_state(Span declaration, std::string const& state) {
  return error(
      "E3002", declaration,
      fmt::format("nothing determines `{0}`: no equation has `{0}'`, and none is left for `{0}` itself", state),
      fmt::format("give an equation for it; what follows from other quantities is a local definition: `let {} = ...`", state));
}
Diagnostic surplus_equation(ast::Equation const& equation, Names const& states) {
  return error("E3003", equation.span, "one equation too many: the others already determine every state",
               fmt::format("states: {}; delete this equation or declare the state it is for", quoted(states)));
}
Diagnostic undetermined(Span declaration, std::string const& unknown) {
  return error("E3005", declaration, fmt::format("the equations do not determine `{}`", unknown),
               "two equations say the same thing about the highest derivatives");
}
Diagnostic initial_of_highest(ast::Reference const& reference, std::string const& state, int order) {
  Names components;
  for (int k = 0; k < order; ++k) components.push_back(primed(state, k));
  return error("E3006", reference.span, fmt::format("`{}` follows from the equations: it has no initial value", primed(reference)),
               fmt::format("`{}` is of order {}: give {}", state, order, quoted(components)));
}
Diagnostic initial_missing(Span declaration, Names const& components) {
  bool const one = components.size() == 1;
  return error("E3007", declaration,
               fmt::format("{} {} no initial value{}", quoted(components), one ? "has" : "have", one ? "" : "s"),
               fmt::format("write `initial {} = 0`", fmt::join(components, " = 0, ")));
}
Diagnostic initial_twice(Span second, Span first, std::string const& component) {
  return conflict("E3008", second, "again here", first, "first given here",
                  fmt::format("the initial value of `{}` is given twice", component), "keep one");
}
Diagnostic initial_moves(Span span) {
  return error("E3009", span, "an initial value cannot read states, inputs or time", "use numbers, constants and parameters");
}
Diagnostic not_a_state(ast::Name const& name, Names const& states) {
  return error("E3010", name.span, fmt::format("`{}` is not a state", name.text),
               guess_or(name.text, states, choose(states, "state")));
}
Diagnostic channel_twice(ast::Name const& name, Span first) {
  return conflict("E3011", name.span, "again here", first, "first observed here",
                  fmt::format("channel `{}` is observed twice", name.text),
                  "one `observe` per channel; two sensors are two channels");
}
Diagnostic nothing_observed(ast::Name const& model) {
  return error("E3012", model.span, fmt::format("model `{}` observes nothing", model.text),
               "say how data arise: `observe displacement ~ normal(y, sd = sigma)`");
}
Diagnostic duplicate_item(ast::Name const& name, std::string const& kind, Span first) {
  return conflict("E3013", name.span, "again here", first, "first here",
                  fmt::format("there are two {}s named `{}`", kind, name.text), "rename one of the two");
}
Diagnostic time_twice(Span second, Span first) {
  return conflict("E3014", second, "again here", first, "first declared here", "time is declared twice", "keep one");
}

Diagnostic no_file(ast::Name const& block) {
  return error("E4101", block.span, fmt::format("data block `{}` names no file", block.text), "add `file \"measurement.csv\"`");
}
Diagnostic no_time(ast::Name const& block) {
  return error("E4102", block.span, fmt::format("data block `{}` does not say when its rows were taken", block.text),
               "add `time t [s]` (a column) or `rate 1000 [Hz]`");
}
Diagnostic time_and_rate(Span second, Span first) {
  return conflict("E4103", second, "and here", first, "here", "times are given twice, by a column and by a rate",
                  "keep one of them");
}
Diagnostic stated_twice(Span second, Span first, std::string const& what) {
  return conflict("E4104", second, "again here", first, "first here", fmt::format("{} is given twice", what), "keep one");
}
Diagnostic rule_missing(Span span, std::string const& input) {
  return error(
      "E4105", span, fmt::format("what does input `{}` do between its samples?", input),
      "add `hold zero_order`, `hold linear`, `hold cubic` or `hold band_limited`: it changes the answer more than anything else");
}
Diagnostic unknown_rule(ast::Name const& rule) {
  Names const known = {"zero_order", "linear", "cubic", "band_limited"};
  std::string help = guess_or(rule.text, known, fmt::format("rules: {}", quoted(known)));
  if (rule.text == "zoh") help = "did you mean `zero_order`?";
  return error("E4106", rule.span, fmt::format("there is no input rule `{}`", rule.text), std::move(help));
}
Diagnostic not_a_time(Span span, Unit const& unit) {
  return error("E4114", span, fmt::format("time cannot be {}", measure(unit)), "give a unit of time: [s], [ms], [min], [h]");
}
Diagnostic rate_not_positive(Span span) {
  return error("E4107", span, "the sampling rate or step must be a positive number",
               "for example `rate 1000 [Hz]` or `step 1 [ms]`");
}
Diagnostic bad_rows(Span span) {
  return error("E4108", span, "rows are whole numbers from 1, the first not after the last",
               "for example `split train = rows 1..500`");
}
Diagnostic input_not_bound(Span span, std::string const& input, std::string const& model, std::string const& data) {
  return error("E4109", span, fmt::format("data `{}` does not give input `{}` of model `{}`", data, input, model),
               fmt::format("add `input {} = COLUMN [unit] hold RULE` to the data block", input));
}
Diagnostic no_channel_bound(Span span, std::string const& model, std::string const& data, Names const& channels) {
  return error("E4110", span, fmt::format("data `{}` measures no channel of model `{}`", data, model),
               fmt::format("add `measure {} = COLUMN [unit]` to the data block", channels.empty() ? "CHANNEL" : channels.front()));
}
Diagnostic unknown_channel(Span span, std::string const& channel, std::string const& model, Names const& channels) {
  return error("E4111", span, fmt::format("model `{}` has no channel `{}`", model, channel),
               guess_or(channel, channels, choose(channels, "channel")));
}
Diagnostic rate_under_zero_order(Span rule, Span use, std::string const& input) {
  return conflict("E4112", rule, "held between samples", use, "its derivative is used here",
                  fmt::format("`{}'` does not exist: input `{}` is held constant between its samples", input, input),
                  "choose `hold linear`, `hold cubic` or `hold band_limited`");
}
Diagnostic unit_mismatch(Span span, std::string const& what, std::string const& column_unit, std::string const& declared_unit) {
  return error("E4113", span, fmt::format("{} is in [{}], the model declares it in [{}]", what, column_unit, declared_unit),
               "the two must measure the same kind of quantity");
}

Diagnostic unknown_item(ast::Name const& name, std::string const& kind, Names const& known) {
  if (kind == "fit" && known.empty())
    return error("E6001", name.span, fmt::format("there is no fit `{}` in this file", name.text),
                 "a fit is a task with a name: `posterior = fit MODEL to DATA with mh(samples = 1000)`");
  return error("E6001", name.span, fmt::format("there is no {} `{}` in this file", kind, name.text),
               guess_or(name.text, known, choose(known, kind)));
}
Diagnostic unknown_member(ast::Name const& name, std::string const& owner, std::string const& kind, Names const& known) {
  return error("E6001", name.span, fmt::format("{} has no {} `{}`", owner, kind, name.text),
               guess_or(name.text, known, choose(known, kind)));
}
Diagnostic unknown_option(Span span, std::string const& option, std::string const& task, Names const& known) {
  return error(
      "E6002", span, fmt::format("`{}` has no option `{}`", task, option),
      guess_or(option, known, known.empty() ? std::string("it has none") : fmt::format("its options are {}", quoted(known))));
}
Diagnostic option_missing(ast::Task const& task, std::string const& option, std::string const& example) {
  return error("E6003", task.verb.span, fmt::format("`{}` needs the option `{}`", task.verb.text, option),
               fmt::format("add `{}` after `with`", example));
}
Diagnostic option_kind(Span span, std::string const& option, std::string const& wanted, std::string const& example) {
  return error("E6004", span, fmt::format("`{}` must be {}", option, wanted), fmt::format("for example `{}`", example));
}
Diagnostic option_range(Span span, std::string const& option, double given, double least, double most) {
  std::string const range = most < 1e9      ? fmt::format("lie between {} and {}", least, most)
                            : least > 1e-15 ? fmt::format("be at least {}", least)
                            : least == 0    ? std::string("not be negative")
                            : least > 0     ? std::string("be positive")
                                            : std::string("be finite");
  return error("E6005", span, fmt::format("`{}` must {}, here it is {}", option, range, given), "correct the number");
}
Diagnostic option_choice(Span span, std::string const& option, std::string const& given, Names const& choices) {
  return error("E6006", span, fmt::format("`{}` cannot be {}", option, given.empty() ? "this" : "`" + given + "`"),
               guess_or(given, choices, fmt::format("choose {}", quoted(choices, "or"))));
}
Diagnostic backend_missing(ast::Task const& task, Names const& known) {
  return error("E6007", task.verb.span, "this fit does not say with what",
               fmt::format("add `with mh(samples = 25000)`; back ends: {}", quoted(known)));
}
Diagnostic unknown_backend(ast::Name const& name, Names const& known) {
  return error("E6008", name.span, fmt::format("there is no back end `{}`", name.text),
               guess_or(name.text, known, fmt::format("back ends: {}", quoted(known))));
}
Diagnostic data_missing(ast::Task const& task, std::string const& preposition) {
  return error("E6009", task.verb.span, fmt::format("this {} names no data", task.verb.text),
               fmt::format("add `{} DATA` or `{} DATA.PART`", preposition, preposition));
}
Diagnostic data_unused(ast::Task const& task, Span data) {
  return error("E6013", data, fmt::format("`{}` takes no data: it makes its own inputs", task.verb.text),
               "leave the data out, or `predict` a fit on them");
}
Diagnostic not_a_fit(ast::Name const& name) {
  return error("E6010", name.span, fmt::format("`{}` is not a fit", name.text), "predict needs the name of a fit task");
}
Diagnostic fixed_parameter(ast::Name const& name, Span declaration) {
  return conflict("E6014", name.span, "another value here", declaration, "fixed here",
                  fmt::format("parameter `{}` has a fixed value in the model", name.text), "change it there, or give it a prior");
}
Diagnostic value_missing(Span span, Names const& parameters) {
  return error("E6011", span, fmt::format("simulating needs a value for {}", quoted(parameters)),
               fmt::format("write `values({} = ..., ...)`", parameters.front()));
}
Diagnostic multisine_beyond_half_rate(Span span, double highest, double half_rate) {
  return error("E6101", span,
               fmt::format("this multisine reaches {:.6g} Hz, half the sampling rate is {:.6g} Hz", highest, half_rate),
               "lower `highest`, or raise `rate`");
}
Diagnostic multisine_without_harmonic(Span span, double lowest, double highest, double resolution) {
  return error("E6101", span,
               fmt::format("no harmonic of the record, a multiple of {:.6g} Hz, lies between {:.6g} and {:.6g} Hz", resolution,
                           lowest, highest),
               "widen the band from `lowest` to `highest`, or take more samples");
}
Diagnostic task_too_late(ast::Name const& name) {
  return error("E6012", name.span, fmt::format("task `{}` comes later in the file", name.text), "tasks run in order: move it up");
}

Diagnostic constant_of_nothing(Span span, std::string const& name, std::string const& model, Names const& known) {
  return error("E6301", span, fmt::format("model `{}` has no parameter `{}`", model, name),
               guess_or(name, known,
                        known.empty() ? fmt::format("declare it in the model: `parameter {} per experiment`", name)
                                      : fmt::format("what a data block may fix: {}", quoted(known))));
}
Diagnostic constant_of_shared(Span span, Span declaration, std::string const& parameter) {
  return conflict("E6302", span, "fixed for one experiment", declaration, "shared by all",
                  fmt::format("parameter `{}` is shared by all experiments, a data block cannot fix it", parameter),
                  fmt::format("declare it as `parameter {} per experiment`, or give it this value in the model", parameter));
}
Diagnostic constant_missing(Span use, Span declaration, std::string const& parameter, std::string const& data) {
  return conflict("E6303", use, "used here", declaration, "neither prior nor value",
                  fmt::format("data `{}` does not say what `{}` is", data, parameter),
                  fmt::format("add `constant {} = ...` to data `{}`, or give the parameter a prior or a value", parameter, data));
}
Diagnostic experiment_twice(Span second, Span first, std::string const& experiment) {
  return conflict("E6304", second, "again", first, "first here",
                  fmt::format("`{}` is used twice: its samples would count twice", experiment), "name every experiment once");
}
Diagnostic experiments_overlap(Span second, Span first, std::string const& one, std::string const& other) {
  return conflict("E6304", second, "these rows", first, "were here already",
                  fmt::format("`{}` and `{}` share rows, which would count twice", one, other), "give them rows of their own");
}
Diagnostic shared_prior_reads_own(Span prior, std::string const& parameter, std::string const& own) {
  return error("E6305", prior,
               fmt::format("the prior of `{}`, which all experiments share, reads `{}`, which each has for itself", parameter, own),
               fmt::format("declare `{}` as `per experiment` too, or let `{}` refer to `{}`: `parameter {} per experiment ~ "
                           "normal({}, sd = ...)`",
                           parameter, own, parameter, own, parameter));
}

}  // namespace sysid::errors
