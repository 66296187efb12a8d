// The checker's wording about Gaussian processes.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {

namespace {

constexpr Synonym kernel_synonyms[] = {
    {"rbf", "squared_exponential"},
    {"se", "squared_exponential"},
    {"gaussian", "squared_exponential"},
    {"exp_quad", "squared_exponential"},
    {"expquad", "squared_exponential"},
    {"exponential", "matern12"},
    {"ou", "matern12"},
    {"cosine", "periodic"},
    {"exp_sine_squared", "periodic"},
    {"bias", "constant"},
    {"dot_product", "linear"},
};

}  // namespace

Diagnostic not_a_process(ast::Name const& name) {
  return about({name.text},
               error("E3201", name.span, fmt::format("`{}` is not a distribution of functions", name.text),
                     "an unknown function is a Gaussian process: `~ gp(squared_exponential(amplitude = s, length = l))`"));
}
Diagnostic one_covariance(Span span) {
  return about({"gp"},
               error("E3201", span, "`gp` takes one argument, its covariance",
                     "kernels are added and multiplied: `gp(matern52(amplitude = s, length = l) + constant(amplitude = s0))`"));
}
Diagnostic not_a_covariance(Span span) {
  return error("E3202", span, "a covariance is a kernel, or a sum or product of kernels",
               "put a constant factor into the amplitude: `squared_exponential(amplitude = 2*s, length = l)`");
}
Diagnostic unknown_kernel(ast::Name const& name, Names const& known) {
  return about({name.text}, error("E3203", name.span, fmt::format("there is no kernel `{}`", name.text),
                                  guess_or(kernel_synonyms, name.text, known, fmt::format("kernels: {}", quoted(known)))));
}
Diagnostic not_an_input_of_process(Span span, std::string const& given, std::string const& process, Names const& inputs) {
  Names names{process};
  if (!given.empty()) names.insert(names.begin(), given);
  return about(names, error("E3204", span,
                            given.empty() ? "the first arguments of a kernel are the names of its inputs"
                                          : fmt::format("`{}` is not an input of `{}`", given, process),
                            guess_or(given, inputs,
                                     fmt::format("{} {}; hyper-parameters are given by name",
                                                 inputs.size() == 1 ? "its input is" : "its inputs are", quoted(inputs)))));
}
Diagnostic kernel_input_twice(Span span, std::string const& input) {
  return about({input}, error("E3204", span, fmt::format("the kernel has the input `{}` twice", input), "list each input once"));
}
Diagnostic kernel_of_one_input(Span span, std::string const& kernel, std::size_t given) {
  return about(
      {kernel},
      error("E3205", span, fmt::format("`{}` is a kernel of one input, but has {} here", kernel, given),
            fmt::format("name the one input that it uses: `{}(INPUT, ...)`; for several inputs multiply kernels of one input each",
                        kernel)));
}
Diagnostic hyper_parameter_count(Span span, std::string const& name, std::size_t given, std::size_t wanted) {
  return about({name},
               error("E3205", span,
                     fmt::format("{} of `{}`, but {} {} needed", counted(given, "value"), name, wanted, wanted == 1 ? "is" : "are"),
                     "give one for each input, in their order, or one for all"));
}
Diagnostic hyper_parameter_unit(Span span, std::string const& name, std::string const& input, Unit const& given, Unit const& wanted,
                                Span input_place, std::optional<Unit> const& of_input) {
  std::string const message =
      fmt::format("the {}{} must be {}", name, input.empty() ? "" : fmt::format(" of `{}`", input), measure(wanted));
  std::string const help = "a length-scale has the unit of its input, an amplitude the unit of the function";
  Names const names = input.empty() ? Names{name} : Names{name, input};
  return about(names, of_input ? conflict("E3206", span, measure(given), input_place, measure(*of_input), message, help)
                               : error("E3206", span, message, help, measure(given)));
}
Diagnostic kernels_of_other_units(Span span, Unit const& left, Unit const& right) {
  return error("E3206", span,
               fmt::format("these kernels belong to functions with different units: {} and {}", measure(left), measure(right)),
               "kernels of one sum describe the same function: give their amplitudes the same unit");
}
Diagnostic hyper_parameter_moves(Span span, std::string const& name, std::string const& what) {
  return error("E3207", span, fmt::format("the {} of a kernel cannot depend on {}", name, what),
               "use numbers, constants and parameters");
}
Diagnostic hyper_parameter_not_positive(Span span, std::string const& name) {
  return error("E3207", span, fmt::format("the {} of a kernel must be positive", name),
               "an amplitude is a standard deviation, a length a distance: give a number above 0");
}
Diagnostic hyper_parameter_never_positive(Span span, std::string const& name, std::string const& process,
                                          std::vector<std::string> const& names) {
  return about(
      {process},
      error("E3207", span, fmt::format("the {} of `{}` must be positive, but its priors allow no positive value", name, process),
            positive_prior(names)));
}
Diagnostic process_in_differential_equation(Span span, std::string const& name) {
  return about(
      {name},
      error(
          "E3208", span,
          fmt::format("`{}` is a Gaussian process known at samples only, but a differential equation needs it between them", name),
          "give the range in which it is needed, and a finite sum approximates it: `gp(..., within = (-0.1 [m], 0.1 [m]))`"));
}
Diagnostic expansion_range(Span span, std::size_t inputs) {
  return about({"within"}, error("E3231", span,
                                 inputs == 1 ? std::string("`within` must be a range: a lower and an upper bound")
                                             : fmt::format("`within` must be a list of {} ranges, one for each input", inputs),
                                 inputs == 1 ? "for example `within = (-0.1 [m], 0.1 [m])`"
                                             : "for example `within = ((-0.1 [m], 0.1 [m]), (-2 [m/s], 2 [m/s]))`"));
}
Diagnostic expansion_range_empty(Span span) {
  return error("E3231", span, "this range is empty", "write the lower bound first: `within = (-0.1 [m], 0.1 [m])`");
}
Diagnostic expansion_without_range(Span span) {
  return about({"terms", "within"}, error("E3231", span, "`terms` needs `within`: basis functions are defined over a range",
                                          "give the range of the function: `within = (-0.1 [m], 0.1 [m])`"));
}
Diagnostic expansion_condition_outside(Span span, std::string const& input) {
  return about({input, "zero_at", "flat_at"},
               error("E3231", span, fmt::format("a point of `zero_at` or `flat_at` lies outside this range of `{}`", input),
                     "widen the range, or remove the condition: the finite sum is defined within its range only"));
}
Diagnostic expansion_of_number(Span span, std::string const& name) {
  return about({name}, error("E3234", span,
                             fmt::format("`{}` is first applied to a plain number, so the unit of its input is not known", name),
                             "give the number a unit, or apply the function to a quantity first"));
}
Diagnostic expansion_beside_process(Span span, std::string const& process, std::string const& expansion) {
  return about(
      {process, expansion},
      error("E3217", span,
            fmt::format("`{}` has no range, but `{}` has one: a model cannot have functions of both kinds", process, expansion),
            fmt::format("give `{}` a range as well: `within = (low, high)`", process)));
}
Diagnostic expansion_by_likelihood(Span span, std::string const& model) {
  return about({model}, error("E3217", span,
                              fmt::format("`{}` has an unknown function, which the likelihood alone does not determine", model),
                              "fit it with map or mh: they use the Gaussian process as prior of its coefficients"));
}
Diagnostic expansion_by_optimum(Span span, std::string const& function, std::string const& parameter) {
  return about(
      {parameter, function, "map"},
      error("E3235", span,
            fmt::format("`map` cannot estimate `{0}`, which scales the function `{1}`, together with `{1}`: the function would "
                        "follow the noise",
                        parameter, function),
            fmt::format("give `{}` a value (`sysid compare` compares fits with different values), or fit with mh", parameter)));
}
Diagnostic expansion_terms(Span span, std::size_t inputs) {
  return about(
      {"terms"},
      error("E3232", span, "`terms`, the number of basis functions along each input, must be a whole number above 0",
            inputs == 1 ? "for example `terms = 16`" : "one number for all inputs, or a list with one for each: `terms = (8, 6)`"));
}
Diagnostic expansion_too_large(Span span, long most) {
  return error("E3232", span, fmt::format("the finite sum has more than {} coefficients", most),
               "use fewer terms along each input, or a sum of kernels of one input each");
}
Diagnostic expansion_too_small(Span span, std::size_t conditions) {
  return error("E3232", span, fmt::format("{} conditions leave no free coefficient: there are too few terms", conditions),
               "use more terms than there are conditions in `zero_at` and `flat_at`");
}
Diagnostic no_expansion(Span span, std::string const& what) {
  return error("E3233", span, fmt::format("{} has no approximation by a finite sum", what),
               "use squared_exponential, matern12, matern32, matern52, linear, constant, oscillator, or a sum of them");
}
Diagnostic expansion_of_lags(Span span, std::string const& name) {
  return about(
      {name},
      error("E3233", span, fmt::format("`{}` is a finite sum: an argument of it must be a single value, not a list of lags", name),
            "if the model is in discrete time, remove `within`; otherwise pass single values"));
}
Diagnostic expansion_unit(Span span, std::string const& name, Unit const& given, Unit const& wanted) {
  return about(
      {name},
      error("E3234", span,
            fmt::format("an earlier argument of `{}` is in [{}], but this one is in [{}]", name, wanted.text, given.text),
            "declare a second function for arguments in this unit, or multiply or divide this argument so that its unit agrees"));
}
Diagnostic process_out_of_place(Span span, std::string const& what) {
  return error("E3209", span, fmt::format("a Gaussian process cannot be {}", what),
               "add it to the mean of a channel: `observe y ~ normal(MEAN + d(u), sd = s)`; lags are allowed in its arguments");
}
Diagnostic process_no_addend(Span span, std::string const& name, std::string const& channel) {
  return about(
      {name, channel},
      error("E3210", span, fmt::format("`{}` must be added to the mean of `{}`", name, channel),
            fmt::format("nonlinear functions of `{0}`, and products of `{0}` with an input or a state, are not supported; put "
                        "a constant factor into the amplitude of `{0}`; write `+ {0}` instead of `- {0}`: the prior of "
                        "`{0}` is the same for both signs",
                        name)));
}
Diagnostic process_added_twice(Span span, std::string const& name, std::string const& channel) {
  return about({name, channel},
               error("E3210", span, fmt::format("`{}` occurs more than once in the mean of `{}`", name, channel),
                     "write it once: put a constant factor into its amplitude, and declare a second function for other arguments"));
}
Diagnostic process_unobserved(Span span, std::string const& name) {
  return about({name}, error("E3210", span, fmt::format("no channel has `{}` in its mean", name),
                             fmt::format("add it to one: `observe y ~ normal(MEAN + {}(...), sd = s)`", name)));
}
Diagnostic process_with_moving_noise(Span span, std::string const& channel) {
  return about(
      {channel},
      error("E3211", span,
            fmt::format("the noise of `{}` changes along the record, which is not supported together with a Gaussian process",
                        channel),
            "make the sd of the noise a parameter, without a factor that changes"));
}
Diagnostic process_without_normal_noise(Span span, std::string const& channel, std::string const& noise) {
  return about({channel},
               error("E3211", span, fmt::format("`{}` has {} noise, but with a Gaussian process it must be normal", channel, noise),
                     "write `normal(..., sd = s)`"));
}
Diagnostic process_applied_twice(Span second, Span first, std::string const& name) {
  return about({name}, conflict("E3212", second, "again here, to other arguments", first, "first applied here",
                                fmt::format("`{}` is applied twice", name),
                                "declare a second function, or give this one a range: `gp(..., within = (LOW, HIGH))`"));
}
Diagnostic process_of_two_channels(Span span, std::string const& name, std::string const& first, std::string const& second) {
  return about({name, first, second},
               error("E3212", span, fmt::format("`{}` occurs in two channels, `{}` and `{}`", name, first, second),
                     "declare a function for each"));
}
Diagnostic process_never_applied(ast::Name const& name) {
  return about({name.text}, error("E3213", name.span, fmt::format("`{}` is declared but never applied", name.text),
                                  fmt::format("add it to the mean of a channel: `observe y ~ normal(MEAN + {}(...), sd = s)`; or "
                                              "give it a range, `gp(..., within = (LOW, HIGH))`, and use it in an equation",
                                              name.text)));
}
Diagnostic process_of_one_experiment(Span span, std::string const& name, std::string const& parameter) {
  return about(
      {name, parameter},
      error("E3214", span, fmt::format("`{}` is one function for all experiments, but `{}` is per experiment", name, parameter),
            "share the parameter, or fit the experiments one by one"));
}

Diagnostic channel_without_process(Span span, std::string const& channel) {
  return about({channel},
               error("E3216", span, fmt::format("`{}` has no Gaussian process, but other channels of the model have one", channel),
                     "give it one, or fit it with a separate model"));
}
Diagnostic process_task(Span span, std::string const& verb, std::string const& model) {
  return about(
      {model},
      error("E3217", span, fmt::format("`{}` has a Gaussian process without a range and cannot be {}", model, verb),
            "give the function a range: `gp(..., within = (LOW, HIGH))`; without one the model can only be simulated, fitted and "
            "predicted"));
}
Diagnostic process_beside_estimated_start(Span span, std::string const& model) {
  return about({model}, error("E3217", span, fmt::format("an estimated start of `{}` would ignore its Gaussian process", model),
                              "make the initial values parameters, `initial y = y0` with `parameter y0 ~ normal(0, sd = ...)`"));
}
Diagnostic process_of_many_samples(Span span, std::string const& model, int most) {
  return about({model},
               error("E3217", span, fmt::format("the Gaussian process of `{}` can be simulated at {} samples at most", model, most),
                     "simulate several records, or a shorter one"));
}
Diagnostic process_beside_constraints(Span span, std::string const& model) {
  return about(
      {model},
      error("E3217", span, fmt::format("`{}` has a Gaussian process and constraints, whose drift would not be checked", model),
            "write the equations in coordinates that satisfy the constraints, or fit the model without the process"));
}
Diagnostic process_feeds_back(Span span, std::string const& rule) {
  return error(
      "E3218", span,
      fmt::format("a Gaussian process cannot be fitted if its arguments are past samples {}: its own values would be its inputs",
                  rule),
      "fit one step ahead, `prediction = one_step`, or use measured samples, `lag(measured(y), 1)`; a prediction can be a "
      "free run");
}
Diagnostic condition_moves(Span span, std::string const& name, std::string const& what) {
  return about({name}, error("E3225", span, fmt::format("`{}` is a point and cannot depend on {}", name, what),
                             "use numbers and constants"));
}
Diagnostic condition_count(Span span, std::string const& name, std::string const& process, std::size_t given, std::size_t wanted) {
  return about({name, process},
               error("E3225", span,
                     fmt::format("a point of `{}` has {}, but `{}` needs {}", name, counted(given, "coordinate"), process, wanted),
                     "give one for each input, `zero_at = (0, 0)`; several points are a list of such lists"));
}
Diagnostic condition_without_derivative(Span span, std::string const& kernel) {
  return about(
      {kernel, "flat_at"},
      error("E3226", span,
            fmt::format("`flat_at` sets a derivative to zero, but functions with the kernel `{}` have no derivative", kernel),
            "`matern32` has one, `matern52` two, `squared_exponential` all; `zero_at` needs none"));
}

}  // namespace sysid::errors
