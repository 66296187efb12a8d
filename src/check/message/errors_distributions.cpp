// The checker's wording about priors and noise.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym distribution_synonyms[] = {
    {"gaussian", "normal"},        {"gauss", "normal"},         {"loguniform", "log_uniform"}, {"reciprocal", "log_uniform"},
    {"lognormal", "log_normal"},   {"jeffreys", "log_uniform"}, {"invgamma", "inverse_gamma"}, {"halfnormal", "half_normal"},
    {"halfcauchy", "half_cauchy"}, {"t", "student_t"},          {"cauchy", "student_t"},
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

}  // namespace

Diagnostic unknown_distribution(ast::Name const& name, Names const& known) {
  return about({name.text},
               error("E2101", name.span, fmt::format("there is no distribution `{}`", name.text),
                     guess_or(distribution_synonyms, name.text, known, fmt::format("distributions: {}", quoted(known)))),
               "distribution");
}

Diagnostic unknown_argument(ast::Name const& argument, std::string const& distribution, Names const& known) {
  return about({distribution, argument.text},
               error("E2102", argument.span, fmt::format("`{}` has no argument `{}`", distribution, argument.text),
                     guess_or(argument_synonyms, argument.text, known, fmt::format("its arguments are {}", quoted(known)))));
}

Diagnostic argument_twice(Span second, Span first, std::string const& spelling, std::string const& other) {
  if (spelling == other)
    return about({spelling}, conflict("E2104", second, "again here", first, "first given here",
                                      fmt::format("`{}` is given twice", spelling), "keep one"));
  return about({other, spelling}, conflict("E2104", second, fmt::format("`{}`", spelling), first, fmt::format("`{}`", other),
                                           fmt::format("`{}` and `{}` are two forms of the same argument", other, spelling),
                                           "keep one: precision = 1/variance, variance = sd^2"));
}

Diagnostic argument_missing(ast::Call const& call, Names const& spellings) {
  return also_about(spellings,
                    about({call.function.text},
                          error("E2105", call.span, fmt::format("`{}` needs {}", call.function.text, quoted(spellings, "or")),
                                fmt::format("write for example `{} = ...`", spellings.front()))));
}

Diagnostic must_be_named(Span span, std::string const& distribution, Names const& spellings) {
  return also_about(
      spellings,
      about({distribution}, error("E2106", span, fmt::format("the name of this argument is missing: {}", quoted(spellings, "or")),
                                  fmt::format("write `{}(..., {} = ...)`", distribution, spellings.front()))));
}

Diagnostic too_many_arguments(Span span, std::string const& distribution, Names const& signature) {
  return about({distribution}, error("E2107", span, fmt::format("`{}` does not take this many arguments", distribution),
                                     signature.empty() ? "it takes none" : fmt::format("its arguments are {}", quoted(signature))));
}

Diagnostic not_a_noise(ast::Call const& call, Names const& known) {
  return about({call.function.text},
               error("E2108", call.function.span, fmt::format("`{}` cannot be the noise of a channel", call.function.text),
                     fmt::format("use {}", quoted(known, "or"))));
}

Diagnostic truncated_noise(ast::Call const& call) {
  return error("E2116", call.span, "the noise of a channel cannot be truncated",
               "remove `lower` and `upper`; bound the parameters instead");
}

Diagnostic cannot_truncate(Span span, std::string const& distribution) {
  return about({distribution},
               error("E2109", span, fmt::format("`{}` cannot be truncated", distribution), "remove `lower` and `upper`"));
}

Diagnostic prior_reads(Span span, std::string const& parameter, std::string const& what) {
  return about({parameter}, error("E2110", span, fmt::format("the prior of `{}` depends on {}", parameter, what),
                                  "a prior can use numbers, constants and other parameters"));
}

Diagnostic prior_cycle(Span span, Names const& loop) {
  return error("E2111", span, fmt::format("these priors depend on each other in a cycle: {}", fmt::join(loop, " -> ")),
               "write one of them without the others");
}

Diagnostic bad_arguments(Span span, std::string const& distribution, std::string_view reason) {
  return about({distribution}, error("E2112", span, fmt::format("the arguments of `{}` are invalid: {}", distribution, reason),
                                     "choose arguments that satisfy this condition"));
}

Diagnostic never_allowed(Span span, std::string const& distribution, std::string const& variate, std::string_view reason,
                         std::vector<std::string> const& names) {
  return about({distribution, variate},
               error("E2112", span,
                     fmt::format("`{}` of `{}` is invalid at all values that the priors allow: {}", distribution, variate, reason),
                     positive_prior(names)));
}

Diagnostic no_mass(Span span, std::string const& distribution) {
  return about({distribution}, error("E2115", span, fmt::format("`{}` has no mass between its bounds", distribution),
                                     "widen `lower` and `upper`, or move the distribution"));
}

Diagnostic unit_of_share(Span span, std::string const& distribution, std::string const& unit) {
  return about({distribution},
               error("E2117", span, fmt::format("`{}` is a distribution of pure numbers, but this needs [{}]", distribution, unit),
                     fmt::format("give this prior to a dimensionless factor and multiply it by a quantity in [{}]", unit)));
}

Diagnostic unit_of_count(Span span, std::string const& distribution, std::string const& unit) {
  return about(
      {distribution},
      error("E2118", span, fmt::format("`{}` is a distribution of counts, but this needs [{}]", distribution, unit),
            "a count is a pure number: divide the expression by the size of one item, and remove the unit of the channel"));
}

Diagnostic count_as_prior(ast::Call const& call) {
  return about(
      {call.function.text},
      error("E2119", call.function.span,
            fmt::format("`{}` is a distribution of counts: it can be the noise of a channel, but not a prior", call.function.text),
            "use a continuous prior, such as gamma or log_normal"));
}

Diagnostic noise_of_counts(Span span, std::string const& channel, std::string const& distribution) {
  return about({channel}, error("E6015", span,
                                fmt::format("channel `{}` measures counts: noise in percent would not give whole numbers", channel),
                                fmt::format("write `noise = model`: the counts are then drawn from `{}`", distribution)));
}

Diagnostic no_prior_or_value(ast::ParameterDeclaration const& parameter) {
  std::string const& name = parameter.name.name.text;
  return about({name}, error("E2113", parameter.name.span, fmt::format("parameter `{}` has neither a prior nor a value", name),
                             fmt::format("give a prior, `parameter {} ~ log_uniform(0.1, 10)`, or a value, `parameter {} = 1`",
                                         name, name)));
}

Diagnostic shared_prior_reads_own(Span prior, std::string const& parameter, std::string const& own) {
  return about(
      {parameter, own},
      error("E6305", prior,
            fmt::format("the prior of `{}`, which all experiments share, depends on `{}`, which is per experiment", parameter, own),
            fmt::format("declare `{}` as `per experiment` too, or let `{}` refer to `{}`: `parameter {} per experiment ~ "
                        "normal({}, sd = ...)`",
                        parameter, own, parameter, own, parameter)));
}

}  // namespace sysid::errors
