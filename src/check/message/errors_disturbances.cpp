// The checker's wording about what was not measured.
#include "check/message/errors_disturbances.hpp"

#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym law_synonyms[] = {
    {"white_noise", "white"},
    {"whitenoise", "white"},
    {"noise", "white"},
    {"wiener", "white"},
    {"brownian", "white"},
    {"gaussian", "white"},
    {"ou", "ornstein_uhlenbeck"},
    {"ornstein", "ornstein_uhlenbeck"},
    {"coloured", "ornstein_uhlenbeck"},
    {"colored", "ornstein_uhlenbeck"},
    {"exponential", "ornstein_uhlenbeck"},
    {"normal", "white"},
};

Diagnostic with_place(Diagnostic diagnostic, std::optional<Span> const& place, std::string text) {
  if (place) diagnostic.secondary.push_back({*place, std::move(text)});
  return diagnostic;
}

}  // namespace

Diagnostic unknown_law(ast::Call const& law, ast::Name const& name, bool discrete, Names const& known) {
  std::string const& given = law.function.text;
  if (discrete)
    return about({given, name.text},
                 error("E3301", law.function.span, fmt::format("`{}` is not a law of a disturbance in discrete time", given),
                       fmt::format("write `disturbance {} ~ normal(0, sd = s)`: its samples are independent; lags make it "
                                   "correlated, as in `y = a*lag(y, 1) + {}`",
                                   name.text, name.text)));
  std::string help = guess_or(law_synonyms, given, known, choose(known, "laws"));
  if (given == "normal")
    help =
        "`normal` is for discrete time; in continuous time write `white(intensity = q)`, or `ornstein_uhlenbeck(sd = s, time = T)` "
        "for correlated noise of standard deviation s";
  return about({given, name.text}, error("E3301", law.function.span,
                                         fmt::format("`{}` is not a law of a disturbance in continuous time", given), help));
}

Diagnostic sd_of_white_noise(Span argument, std::string const& name) {
  return about({name},
               error("E3302", argument, "white noise in continuous time has no standard deviation: its variance is infinite",
                     "state its intensity, `white(intensity = q)`; a disturbance of standard deviation s that is correlated "
                     "over a time T is `ornstein_uhlenbeck(sd = s, time = T)`, which acts on slow motions as white noise of "
                     "intensity `2*s^2*T`"));
}

Diagnostic unit_of_intensity(Span argument, std::string const& name, std::string const& given, std::string const& wanted) {
  return about({name}, error("E3302", argument,
                             fmt::format("the intensity of `{}` must be in [{}], but this is in [{}]", name, wanted, given),
                             "the intensity is the variance of the integral of the disturbance, per second; a disturbance of "
                             "standard deviation s that is correlated over a time T is `ornstein_uhlenbeck(sd = s, time = T)`"));
}

Diagnostic law_reads(Span law, std::string const& name, std::string const& what) {
  return about({name}, error("E3303", law, fmt::format("the law of `{}` depends on {}", name, what),
                             "its arguments are expressions of constants and parameters; if the size of the disturbance changes "
                             "with time, multiply it by a factor in the equation, as in `abs(y')*w`"));
}

Diagnostic law_never_positive(Span declaration, std::string const& name, std::string const& argument, Names const& parameters) {
  return about({name}, error("E3304", declaration, fmt::format("the {} of `{}` must be positive, but it never is", argument, name),
                             positive_prior(parameters)));
}

Diagnostic mean_of_disturbance(Span law, std::string const& name) {
  return about({name},
               error("E3305", law, fmt::format("the mean of disturbance `{}` must be 0", name),
                     fmt::format("write `normal(0, sd = s)` and add the mean to the equation as a parameter: `{} + m`", name)));
}

Diagnostic bounds_of_disturbance(Span law, std::string const& name) {
  return about({name}, error("E3305", law, fmt::format("disturbance `{}` cannot have bounds", name), "write `normal(0, sd = s)`"));
}

Diagnostic rate_of_disturbance(ast::Reference const& reference) {
  return about({reference.name.text, primed(reference)},
               error("E2007", reference.span, fmt::format("`{}` is a disturbance: it has no time derivative", reference.name.text),
                     "for a smoother disturbance declare a state that white noise drives, as `state f` in `T*f' + f = w`"));
}

Diagnostic white_noise_observed(Span reader, Subject const& what, Span declaration, std::string const& disturbance) {
  Diagnostic diagnostic = error("E3306", reader, fmt::format("{} depends on white noise, which has no finite variance", what.words),
                                fmt::format("make `{}` correlated in time, `ornstein_uhlenbeck(sd = s, time = T)`, or use a "
                                            "quantity that it affects only through a state, such as a velocity in place of an "
                                            "acceleration",
                                            disturbance));
  diagnostic.secondary.push_back({declaration, "white noise"});
  Names names = what.names;
  names.push_back(disturbance);
  return about(names, std::move(diagnostic));
}

Diagnostic not_linear_in_disturbance(Span declaration, std::string const& disturbance, std::optional<Span> const& part) {
  std::string const help = fmt::format(
      "white noise may be multiplied by anything but white noise; for other functions make it correlated in time: `{} ~ "
      "ornstein_uhlenbeck(sd = "
      "s, "
      "time = T)`",
      disturbance);
  std::string const message = fmt::format("the equations are not linear in disturbance `{}`", disturbance);
  if (!part) return about({disturbance}, error("E3307", declaration, message, help));
  return about({disturbance}, with_place(error("E3307", *part, message, help), declaration, "white noise"));
}

Diagnostic unused_disturbance(Span declaration, std::string const& disturbance) {
  return about(
      {disturbance},
      error("E3308", declaration, fmt::format("disturbance `{}` is not used in any equation or channel", disturbance),
            fmt::format("add it to the equation that it disturbs, as in `m*y'' + k*y = x + {}`, or remove it", disturbance)));
}

Diagnostic disturbance_beside(Span place, Subject const& disturbance, Subject const& other, std::string const& help) {
  Names names = disturbance.names;
  names.insert(names.end(), other.names.begin(), other.names.end());
  return about(names, error("E3309", place, fmt::format("{} cannot be combined with {}", disturbance.words, other.words), help));
}

Diagnostic law_of_initial(ast::Call const& law, std::string const& state) {
  return about(
      {law.function.text, state},
      error("E3310", law.function.span, fmt::format("the initial value of `{}` can only be normal", state),
            fmt::format("write `initial {0} ~ normal(0, sd = s)`; for another distribution estimate it: `parameter start ~ "
                        "{1}(...)` and `initial {0} = start`",
                        state, law.function.text)));
}

Diagnostic bounds_of_initial(ast::Call const& law, std::string const& state) {
  return about({state},
               error("E3310", law.span, fmt::format("the random initial value of `{}` cannot have bounds", state),
                     fmt::format("remove them, or estimate the value: `parameter start ~ {}(...)` and `initial {} = start`",
                                 law.function.text, state)));
}

Diagnostic random_guess(Span initial, std::string const& unknown) {
  return about({unknown}, error("E3310", initial, fmt::format("the first value of `{}` follows from the equations", unknown),
                                fmt::format("write a starting guess in place of the distribution, `initial {} = 0`", unknown)));
}

Diagnostic estimated_and_random_start(Span option, Span initial, std::string const& state) {
  return about({"start", state}, conflict("E3311", option, "estimated", initial, "random",
                                          fmt::format("the initial value of `{}` cannot be both random and estimated", state),
                                          "remove the option, or write a value in place of the distribution"));
}

Diagnostic filter_of_nothing(Span option, std::string const& model) {
  return about({"filter", model},
               error("E3312", option, fmt::format("model `{}` has no random states, so it needs no filter", model),
                     "remove the option, or declare an unmeasured force or input: `disturbance w [N] ~ white(intensity = q)`"));
}

Diagnostic kalman_of_nonlinear(Span option, std::string const& model, std::optional<Span> const& part) {
  return about(
      {"filter", "kalman", model},
      with_place(
          error("E3313", option, fmt::format("`kalman` needs linear equations and channels; those of `{}` are not linear", model),
                "write `filter = extended` or `unscented`, or remove the option: the filter is then chosen automatically"),
          part, "not linear"));
}

Diagnostic noise_of_filter(Span channel, std::string const& name, std::string const& noise, Span task, std::string const& help) {
  Diagnostic diagnostic = error(
      "E3314", channel,
      fmt::format("with random states this task needs normal noise, but the noise of channel `{}` is `{}`", name, noise), help);
  diagnostic.secondary.push_back({task, "fitted here"});
  return about({name, noise}, std::move(diagnostic));
}

Diagnostic steps_ahead_of_known(Span option, std::string const& model) {
  return about({model},
               error("E3320", option,
                     fmt::format("model `{}` has no random states, so its predictions do not depend on measured samples", model),
                     "remove the option, or declare an unmeasured force or input: `disturbance w ~ white(intensity = q)`"));
}

Diagnostic steps_ahead_of_several(Span option) {
  return error("E3320", option, "a prediction a given number of rows ahead is possible with one model only",
               "predict with each fit alone, or write `prediction = one_step` or `free_run`");
}

Diagnostic likelihood_by_particles(Span place, Subject const& what, std::string const& help) {
  Names names = what.names;
  names.insert(names.end(), {"filter", "particle"});
  return about(names,
               error("E3319", place,
                     fmt::format("{}, but `filter = particle` gives only random estimates of the likelihood", what.words), help));
}

Diagnostic particles_of_other_filter(Span option, std::string const& filter) {
  return about(
      {"particles", "filter", filter},
      error("E3321", option, fmt::format("`particles` is an option for `filter = particle`, but the filter is `{}`", filter),
            "remove the option, or write `filter = particle`"));
}

Diagnostic law_of_input_error(Span law, std::string const& input, std::string const& reason) {
  return about({input}, error("E3315", law, fmt::format("the error of input `{}` {}", input, reason),
                              "write its standard deviation as a number: `error normal(sd = 0.5)`"));
}

Diagnostic input_error_refused(Span error_place, std::string const& input, Subject const& reason, std::optional<Label> const& place,
                               std::string const& help) {
  Diagnostic diagnostic =
      error("E3316", error_place, fmt::format("input `{}` cannot have an error: {}", input, reason.words), help);
  if (place) diagnostic.secondary.push_back(*place);
  Names names = reason.names;
  names.push_back(input);
  return about(names, std::move(diagnostic));
}

Diagnostic input_errors_differ(Span second, Span first, std::string const& input, std::string const& one,
                               std::string const& other) {
  return about({input}, conflict("E3317", second, one, first, other,
                                 fmt::format("the experiments of one task state different errors of input `{}`", input),
                                 "state the same error in both data blocks, or none"));
}

}  // namespace sysid::errors
