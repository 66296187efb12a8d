// Distributions and arguments that are not known here, mostly those of other programs: how they are written.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "check/message/error_words.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym distribution_synonyms[] = {{"gaussian", "normal"},
                                             {"gauss", "normal"},
                                             {"reciprocal", "log_uniform"},
                                             {"jeffreys", "log_flat"},
                                             {"improper", "flat"},
                                             {"invgamma", "inverse_gamma"},
                                             {"t", "student_t"},
                                             {"n", "normal"},
                                             {"norm", "normal"},
                                             {"u", "uniform"},
                                             {"unif", "uniform"},
                                             {"exp", "log_normal"},
                                             {"expon", "exponential"},
                                             {"inv_gamma", "inverse_gamma"},
                                             {"igamma", "inverse_gamma"},
                                             {"dnorm", "normal"},
                                             {"dunif", "uniform"},
                                             {"dgamma", "gamma"},
                                             {"dbeta", "beta"},
                                             {"dexp", "exponential"},
                                             {"dlnorm", "log_normal"},
                                             {"dt", "student_t"}};

/// `sigma` is the scale of Student's t, whose sd is larger.
constexpr Synonym argument_synonyms[] = {{"sigma", "scale"},
                                         {"sigma", "sd"},
                                         {"mu", "location"},
                                         {"meanlog", "log_mean"},
                                         {"mean_log", "log_mean"},
                                         {"mu_log", "log_mean"},
                                         {"sdlog", "log_sd"},
                                         {"sd_log", "log_sd"},
                                         {"std", "sd"},
                                         {"stdev", "sd"},
                                         {"stddev", "sd"},
                                         {"var", "variance"},
                                         {"mu", "mean"},
                                         {"mu", "log_mean"},
                                         {"tau", "precision"},
                                         {"min", "lower"},
                                         {"low", "lower"},
                                         {"max", "upper"},
                                         {"high", "upper"},
                                         {"nu", "degrees_of_freedom"},
                                         {"df", "degrees_of_freedom"},
                                         {"noise", "sd"},
                                         {"loc", "mean"},
                                         {"loc", "location"},
                                         {"scale", "sd"},
                                         {"lb", "lower"},
                                         {"ub", "upper"},
                                         {"lambda", "rate"},
                                         {"theta", "scale"},
                                         {"alpha", "shape"},
                                         {"beta", "rate"},
                                         {"beta", "scale"},
                                         {"scale", "mean"},
                                         {"a", "shape"},
                                         {"alpha", "a"},
                                         {"beta", "b"}};

std::string written_here(LogNormalOfOthers const& written) {
  std::string const of_logarithm =
      fmt::format("write `{}`, if its arguments are the mean and the sd of the logarithm", written.of_logarithm);
  if (written.of_median.empty()) return of_logarithm;
  std::string const of_median = fmt::format("write `{}`, if the first is the median", written.of_median);
  return written.median_first ? of_median + "; " + of_logarithm : of_logarithm + "; " + of_median;
}

/// Of a gamma distribution by its mean and sd or variance, which are those of one shape.
std::string gamma_by_moments(ast::Name const& argument) {
  if (argument.text != "sd" && argument.text != "variance") return {};
  return fmt::format("write `gamma(shape = S, mean = M)`, of sd M/sqrt(S): S is M^2/{}",
                     argument.text == "sd" ? "sd^2" : "variance");
}

constexpr std::array<std::string_view, 6> start_words{"start", "init", "initval", "initial", "testval", "value"};
constexpr std::array<std::string_view, 6> truncations{"truncated", "truncate",        "trunc",
                                                      "truncnorm", "truncatednormal", "truncated_normal"};
constexpr std::array<std::string_view, 5> points{"delta", "dirac", "point", "fixed", "deterministic"};

/// How a distribution of another name is written here; empty where a guess is as good.
std::string other_distribution(std::string const& small) {
  if (std::find(truncations.begin(), truncations.end(), small) != truncations.end())
    return "bounds are arguments of a distribution: `normal(0, sd = 1, lower = 0, upper = 2)`";
  if (small == "half_student_t" || small == "half_t")
    return "half of Student's t is written `student_t(0, 3, scale = 1, lower = 0)`";
  if (small == "cauchy") return "write it as Student's t: for `cauchy(0, 0.05)` it is `student_t(0, 1, scale = 0.05)`";
  if (small == "std_normal" || small == "standard_normal") return "write `normal(0, sd = 1)`";
  if (std::find(points.begin(), points.end(), small) != points.end())
    return "a fixed value has no distribution: write `= VALUE` in place of `~`";
  if (small == "log10_uniform" || small == "log10uniform")
    return "bounds are values, not logarithms: from -1 to 2 of log10 is `log_uniform(0.1, 100)`";
  if (small.starts_with("log10"))
    return "logarithms are natural: for a mean of -1.5 of log10 write `log_normal(median = 10^-1.5, sd = ...)`, with an sd log(10) "
           "times as large";
  return {};
}

std::string other_argument(ast::Name const& argument, std::string const& distribution, Names const& known) {
  if (std::find(start_words.begin(), start_words.end(), argument.text) != start_words.end())
    return "remove it: a parameter has no start value, the search begins at draws of the prior";
  if (known == Names{"lower", "upper"} && (argument.text == "a" || argument.text == "b"))
    return fmt::format("did you mean `{}`?", argument.text == "a" ? "lower" : "upper");
  // A mean where a median or the mean of the logarithm can be given: neither is it.
  bool const logarithmic = std::find(known.begin(), known.end(), "log_mean") != known.end();
  if (logarithmic && argument.text == "mean")
    return "write `log_mean` for the mean of the logarithm, `median` for the median (half of the values lie below it); "
           "the mean itself is median*exp(sd^2/2)";
  if (logarithmic && (argument.text == "gsd" || argument.text == "geometric_sd"))
    return "write `sd` as its logarithm: a factor of 2 is `sd = log(2)`";
  if (logarithmic && argument.text.starts_with("log10"))
    return "logarithms are natural: for a mean of -1.5 of log10 write `median = 10^-1.5`, and an sd log(10) times as large";
  return distribution == "gamma" ? gamma_by_moments(argument) : std::string();
}

}  // namespace

Diagnostic unknown_distribution(ast::Name const& name, Names const& known, LogNormalOfOthers const& written) {
  std::string help = written.of_logarithm.empty() ? other_distribution(in_small_letters(name.text)) : written_here(written);
  if (help.empty()) help = guess_or(distribution_synonyms, name.text, known, fmt::format("distributions: {}", quoted(known)));
  return about({name.text}, error("E2101", name.span, fmt::format("there is no distribution `{}`", name.text), std::move(help)),
               "distribution");
}

Diagnostic unknown_argument(ast::Name const& argument, std::string const& distribution, Names const& known) {
  std::string help = other_argument(argument, distribution, known);
  if (help.empty())
    help = guess_or(argument_synonyms, argument.text, known,
                    fmt::format("{} {}", known.size() == 1 ? "its argument is" : "its arguments are", quoted(known)));
  return about(
      {distribution, argument.text},
      error("E2102", argument.span, fmt::format("`{}` has no argument `{}`", distribution, argument.text), std::move(help)));
}

}  // namespace sysid::errors
