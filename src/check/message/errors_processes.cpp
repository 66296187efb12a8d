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
    {"matern_12", "matern12"},
    {"matern_32", "matern32"},
    {"matern_52", "matern52"},
    {"matern", "matern52"},
    {"cosine", "periodic"},
    {"exp_sine_squared", "periodic"},
    {"bias", "constant"},
    {"dot_product", "linear"},
};

}  // namespace

Diagnostic not_a_process(ast::Name const& name) {
  return about({name.text},
               error("E3201", name.span, fmt::format("`{}` is no distribution of functions", name.text),
                     "an unknown function is a Gaussian process: `~ gp(squared_exponential(amplitude = s, length = l))`"));
}
Diagnostic one_covariance(Span span) {
  return error("E3201", span, "`gp` takes one argument, its covariance",
               "kernels are added and multiplied: `gp(matern52(amplitude = s, length = l) + constant(amplitude = s0))`");
}
Diagnostic not_a_covariance(Span span) {
  return error("E3202", span, "a covariance is a kernel, or a sum or product of kernels",
               "a factor belongs into the amplitude: `squared_exponential(amplitude = 2*s, length = l)`");
}
Diagnostic unknown_kernel(ast::Name const& name, Names const& known) {
  return about({name.text}, error("E3203", name.span, fmt::format("there is no kernel `{}`", name.text),
                                  guess_or(kernel_synonyms, name.text, known, fmt::format("kernels: {}", quoted(known)))));
}
Diagnostic not_an_input_of_process(Span span, std::string const& given, std::string const& process, Names const& inputs) {
  return error("E3204", span,
               given.empty() ? "what stands first in a kernel are the names of the inputs that it reads"
                             : fmt::format("`{}` is no input of `{}`", given, process),
               guess_or(given, inputs, fmt::format("its inputs are {}; hyper-parameters go by their names", quoted(inputs))));
}
Diagnostic kernel_input_twice(Span span, std::string const& input) {
  return about({input}, error("E3204", span, fmt::format("the kernel reads `{}` twice", input), "name each input once"));
}
Diagnostic kernel_of_one_input(Span span, std::string const& kernel, std::size_t given) {
  return about({kernel}, error("E3205", span, fmt::format("`{}` is a kernel of one input, here it has {}", kernel, given),
                               "say which: `periodic(day, amplitude = s, ...)`; a product of kernels reads several"));
}
Diagnostic hyper_parameter_count(Span span, std::string const& name, std::size_t given, std::size_t wanted) {
  return about({name}, error("E3205", span,
                             fmt::format("{} of `{}`, where {} {} needed", counted(given, "value"), name, wanted,
                                         wanted == 1 ? "is" : "are"),
                             "give one for each input, in their order, or one for all"));
}
Diagnostic hyper_parameter_unit(Span span, std::string const& name, std::string const& input, Unit const& given, Unit const& wanted,
                                Span input_place, std::optional<Unit> const& of_input) {
  std::string const message =
      fmt::format("the {}{} must be {}", name, input.empty() ? "" : fmt::format(" of `{}`", input), measure(wanted));
  std::string const help = "a length-scale has the unit of its input, an amplitude that of the function's values";
  return of_input ? conflict("E3206", span, measure(given), input_place, measure(*of_input), message, help)
                  : error("E3206", span, message, help, measure(given));
}
Diagnostic kernels_of_other_units(Span span, Unit const& left, Unit const& right) {
  return error("E3206", span, fmt::format("kernels are added whose functions are {} and {}", measure(left), measure(right)),
               "addends of one covariance are of one function: give their amplitudes one unit");
}
Diagnostic hyper_parameter_moves(Span span, std::string const& name, std::string const& what) {
  return error("E3207", span, fmt::format("the {} of a kernel cannot read {}", name, what),
               "use numbers, constants and parameters");
}
Diagnostic hyper_parameter_not_positive(Span span, std::string const& name) {
  return error("E3207", span, fmt::format("the {} of a kernel must be positive", name),
               "an amplitude is a standard deviation, a length a distance: give a number above 0");
}
Diagnostic hyper_parameter_never_positive(Span span, std::string const& name, std::string const& process,
                                          std::vector<std::string> const& names) {
  return about({process},
               error("E3207", span, fmt::format("the {} of `{}` must be positive, and its priors never make it so", name, process),
                     positive_prior(names)));
}
Diagnostic process_in_differential_equation(Span span, std::string const& name) {
  return about(
      {name},
      error(
          "E3208", span,
          fmt::format("`{}` is a Gaussian process: it is known at samples, a differential equation needs it between them", name),
          "say where it is wanted and it becomes a finite sum that an equation can hold: `gp(..., within = (-0.1 [m], 0.1 [m]))`"));
}
Diagnostic expansion_range(Span span, std::size_t inputs) {
  return error("E3231", span,
               inputs == 1 ? std::string("`within` is a range: a low and a high end")
                           : fmt::format("`within` is a list of {} ranges, one for each input", inputs),
               inputs == 1 ? "for example `within = (-0.1 [m], 0.1 [m])`"
                           : "for example `within = ((-0.1 [m], 0.1 [m]), (-2 [m/s], 2 [m/s]))`");
}
Diagnostic expansion_range_empty(Span span) {
  return error("E3231", span, "this range is empty", "its low end comes first: `within = (-0.1 [m], 0.1 [m])`");
}
Diagnostic expansion_without_range(Span span) {
  return error("E3231", span, "`terms` needs `within`: functions are spread over a range",
               "say where the function is wanted: `within = (-0.1 [m], 0.1 [m])`");
}
Diagnostic expansion_condition_outside(Span span, std::string const& input) {
  return about({input},
               error("E3231", span, fmt::format("a point of `zero_at` or `flat_at` lies outside this range of `{}`", input),
                     "the function is a sum on its range alone: widen it, or leave the condition out"));
}
Diagnostic expansion_of_number(Span span, std::string const& name) {
  return about(
      {name},
      error("E3234", span, fmt::format("`{}` is first applied to a plain number, which does not tell the unit of its input", name),
            "give the number its unit, or apply the function to a quantity before"));
}
Diagnostic expansion_beside_process(Span span, std::string const& process, std::string const& expansion) {
  return about({process, expansion},
               error("E3217", span, fmt::format("`{}` is a process at samples beside `{}`, a finite sum", process, expansion),
                     fmt::format("give `{}` a range, too: `within = (low, high)`", process)));
}
Diagnostic expansion_by_likelihood(Span span, std::string const& model) {
  return about({model}, error("E3217", span,
                              fmt::format("`{}` has an unknown function, which by likelihood alone is anything that fits", model),
                              "its process is the prior of its coefficients: fit it with map or mh"));
}
Diagnostic expansion_by_optimum(Span span, std::string const& function, std::string const& parameter) {
  return about(
      {parameter, function},
      error("E3235", span,
            fmt::format("`map` would find `{}` together with the function `{}` that it scales, which follows the noise", parameter,
                        function),
            fmt::format("give `{}` a value (fits with several are weighed by `sysid compare`), or fit with mh", parameter)));
}
Diagnostic expansion_terms(Span span, std::size_t inputs) {
  return error(
      "E3232", span, "`terms` is how many functions there are along each input: a whole number above 0",
      inputs == 1 ? "for example `terms = 16`" : "one number for all inputs, or a list with one for each: `terms = (8, 6)`");
}
Diagnostic expansion_too_large(Span span, long most) {
  return error("E3232", span, fmt::format("more than {} coefficients", most),
               "take fewer terms along each input, or a sum of kernels that read one input each");
}
Diagnostic expansion_too_small(Span span, std::size_t conditions) {
  return error("E3232", span, fmt::format("{} conditions leave nothing of so few terms", conditions),
               "give it more terms than `zero_at` and `flat_at` take away");
}
Diagnostic no_expansion(Span span, std::string const& what) {
  return error("E3233", span, fmt::format("{} has no finite sum that stands for it", what),
               "take one of squared_exponential, matern12, matern32, matern52, linear, constant, or a sum of them");
}
Diagnostic expansion_of_lags(Span span, std::string const& name) {
  return about({name},
               error("E3233", span, fmt::format("`{}` is a finite sum over a box, which lags have too many sides for", name),
                     "leave `within` out where the model is one of samples, or pass single values"));
}
Diagnostic expansion_unit(Span span, std::string const& name, Unit const& given, Unit const& wanted) {
  return about({name},
               error("E3234", span, fmt::format("`{}` was applied to [{}] before, this is [{}]", name, wanted.text, given.text),
                     "declare a second function, or convert"));
}
Diagnostic process_out_of_place(Span span, std::string const& what) {
  return error("E3209", span, fmt::format("a Gaussian process cannot be {}", what),
               "add it to what a channel is centred on: `observe y ~ normal(F + d(u), sd = s)`; lags belong to its arguments");
}
Diagnostic process_no_addend(Span span, std::string const& name, std::string const& channel) {
  return about({name, channel},
               error("E3210", span, fmt::format("`{}` must be an addend of what `{}` is centred on", name, channel),
                     "a factor belongs into its amplitude; a function of it would not be normal"));
}
Diagnostic process_added_twice(Span span, std::string const& name, std::string const& channel) {
  return about(
      {name, channel},
      error("E3210", span, fmt::format("`{}` stands more than once in what `{}` is centred on", name, channel),
            "write it once: a multiple of it is a function with a larger amplitude, and other arguments want a second function"));
}
Diagnostic process_unobserved(Span span, std::string const& name) {
  return about({name}, error("E3210", span, fmt::format("no channel is centred on `{}`", name),
                             fmt::format("add it to one: `observe y ~ normal(F + {}(...), sd = s)`", name)));
}
Diagnostic process_with_moving_noise(Span span, std::string const& channel) {
  return about(
      {channel},
      error("E3211", span,
            fmt::format("the noise of `{}` changes along the record, which a Gaussian process beside it does not allow", channel),
            "let its width be a parameter"));
}
Diagnostic process_without_normal_noise(Span span, std::string const& channel, std::string const& noise) {
  return about({channel},
               error("E3211", span, fmt::format("`{}` has {} noise, beside a Gaussian process it must be normal", channel, noise),
                     "write `normal(..., sd = s)`"));
}
Diagnostic process_applied_twice(Span second, Span first, std::string const& name) {
  return about({name}, conflict("E3212", second, "again here, to something else", first, "first applied here",
                                fmt::format("`{}` is applied twice", name), "declare a second function"));
}
Diagnostic process_of_two_channels(Span span, std::string const& name, std::string const& first, std::string const& second) {
  return about({name, first, second},
               error("E3212", span, fmt::format("`{}` stands in two channels, `{}` and `{}`", name, first, second),
                     "declare a function for each"));
}
Diagnostic process_never_applied(ast::Name const& name) {
  return about({name.text},
               error("E3213", name.span, fmt::format("`{}` is declared and never applied", name.text),
                     fmt::format("add it to what a channel is centred on: `observe y ~ normal(F + {}(...), sd = s)`", name.text)));
}
Diagnostic process_of_one_experiment(Span span, std::string const& name, std::string const& parameter) {
  return about(
      {name, parameter},
      error("E3214", span, fmt::format("`{}` is one function for all experiments, and `{}` is per experiment", name, parameter),
            "share the parameter, or fit the experiments one by one"));
}

Diagnostic channel_without_process(Span span, std::string const& channel) {
  return about({channel},
               error("E3216", span, fmt::format("`{}` has no Gaussian process, other channels of the model have", channel),
                     "give it one, or fit it with a model of its own"));
}
Diagnostic process_task(Span span, std::string const& verb, std::string const& model) {
  return about({model}, error("E3217", span, fmt::format("`{}` has a Gaussian process and cannot be {}", model, verb),
                              "such a model is fitted and predicted: `posterior = fit ... with map`"));
}
Diagnostic process_beside_estimated_start(Span span, std::string const& model) {
  return about({model},
               error("E3217", span,
                     fmt::format("the start of `{}` would be estimated from its first rows without its Gaussian process", model),
                     "make the initial values parameters, `initial y = y0` with `parameter y0 ~ normal(0, sd = ...)`"));
}
Diagnostic process_of_many_samples(Span span, std::string const& model, int most) {
  return about({model}, error("E3217", span,
                              fmt::format("the Gaussian process of `{}` is simulated at no more than {} samples", model, most),
                              "make several records, or a shorter one"));
}
Diagnostic process_beside_constraints(Span span, std::string const& model) {
  return about(
      {model},
      error("E3217", span, fmt::format("`{}` has a Gaussian process beside constraints, whose drift would not be measured", model),
            "write the equations in coordinates that meet the constraints, or fit them without the process"));
}
Diagnostic process_feeds_back(Span span, std::string const& rule) {
  return error(
      "E3218", span, fmt::format("a Gaussian process is not fitted {}: its values would be inputs of its own", rule),
      "fit one step ahead, `prediction = one_step`, or read measured samples, `lag(measured(y), 1)`; predictions may run free");
}
Diagnostic condition_moves(Span span, std::string const& name, std::string const& what) {
  return about({name},
               error("E3225", span, fmt::format("`{}` is a point, it cannot read {}", name, what), "use numbers and constants"));
}
Diagnostic condition_count(Span span, std::string const& name, std::string const& process, std::size_t given, std::size_t wanted) {
  return about({name, process},
               error("E3225", span,
                     fmt::format("a point of `{}` has {}, `{}` needs {}", name, counted(given, "coordinate"), process, wanted),
                     "give one for each input, `zero_at = (0, 0)`; several points are a list of such lists"));
}
Diagnostic condition_without_derivative(Span span, std::string const& kernel) {
  return about({kernel},
               error("E3226", span, fmt::format("functions of `{}` have no derivative, which `flat_at` sets to zero", kernel),
                     "`matern32` has one, `matern52` two, `squared_exponential` all; `zero_at` needs none"));
}

}  // namespace sysid::errors
