// The checker's wording about samples, lags and discrete time.
#include <fmt/format.h>

#include <cmath>

#include "check/message/error_words.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

/// k of `t + k`, `t - k`, `t`, -1 of `-1`: what is written with an index that counts samples; nothing for other indices.
std::optional<int> shift_of(ast::Expression const& index) {
  if (std::holds_alternative<ast::Reference>(index.node)) return 0;
  if (auto const* minus = std::get_if<ast::Box<ast::Unary>>(&index.node)) {
    auto const* back = std::get_if<ast::Number>(&(*minus)->operand->node);
    bool const counts =
        back != nullptr && !back->unit && back->value > 0 && back->value < 10000 && back->value == std::floor(back->value);
    return counts ? std::optional(-static_cast<int>(back->value)) : std::nullopt;
  }
  auto const* sum = std::get_if<ast::Box<ast::Binary>>(&index.node);
  if (sum == nullptr || ((*sum)->symbol != "-" && (*sum)->symbol != "+")) return std::nullopt;
  auto const* count = std::get_if<ast::Number>(&(*sum)->right->node);
  constexpr double most = 10000;
  if (!std::holds_alternative<ast::Reference>((*sum)->left->node) || count == nullptr || count->unit || !(count->value <= most) ||
      count->value != std::floor(count->value))
    return std::nullopt;
  return static_cast<int>((*sum)->symbol == "-" ? -count->value : count->value);
}

}  // namespace

Diagnostic lag_without_discrete_time(ast::Call const& call) {
  return about(
      {call.function.text},
      error("E3101", call.span, fmt::format("`{}` counts samples, but the time of this model is continuous", call.function.text),
            "declare `time discrete 0.1 [s]`, or write a differential equation"));
}
Diagnostic lag_count(Span span) {
  return error("E3102", span, "a lag is a whole number of samples: `lag(y, 1)`, `lags(y, 1..4)`",
               "0 is the present sample, 1 the one before; `lag` takes one number, `lags` a range from the smaller number to the "
               "larger");
}
Diagnostic lags_out_of_place(ast::Call const& call) {
  return about({call.function.text},
               error("E3103", call.span, "`lags` gives several values, but one is needed here",
                     "use it as the arguments of a function: `f(lags(y, 1..3))`; for one sample write `lag(y, 1)`"));
}
Diagnostic primes_in_discrete_time(ast::Reference const& reference) {
  return about({reference.name.text, primed(reference)},
               error("E3104", reference.span, fmt::format("`{}`: there are no derivatives in discrete time", primed(reference)),
                     fmt::format("write differences of samples: `{0} - lag({0}, 1)`; or remove `discrete`", reference.name.text)));
}
Diagnostic channel_as_quantity(ast::Name const& name, bool discrete, std::string const& past) {
  return about({name.text},
               error("E2001", name.span,
                     fmt::format("`{}` is a measured channel: its name alone cannot be used in an expression", name.text),
                     discrete ? fmt::format("its earlier samples are `{}`", past)
                              : fmt::format("write what the channel observes: the expression after `observe {} ~`", name.text)));
}
std::optional<Diagnostic> sample_by_index(Span span, ast::Expression const& index, IndexedQuantity const& what) {
  std::optional<int> const shift = shift_of(index);
  if (!shift) return std::nullopt;
  auto const lag = [&](int count) {
    return what.is_channel ? fmt::format("lag(measured({}), {})", what.name, count) : fmt::format("lag({}, {})", what.name, count);
  };
  std::string const written = fmt::format(fmt::runtime(what.in_brackets ? "{}[{}]" : "{}({})"), what.name, unparse(index));
  std::string help;
  if (*shift < 0)
    help = fmt::format("{} `{}`", *shift == -1 ? "the sample before is" : "this earlier sample is", lag(-*shift));
  else if (*shift == 0)
    help = what.is_channel ? fmt::format("an equation cannot read the present sample; the one before is `{}`", lag(1))
                           : fmt::format("the present sample is `{}`; the one before is `{}`", what.name, lag(1));
  else
    help = fmt::format("write the equation for the present sample: `{}` in place of `{}`, and lags that are larger by {}",
                       what.name, written, *shift);
  return about({what.name}, error(what.in_brackets ? "E2707" : "E2003", span,
                                  fmt::format("`{}`: samples are not written with an index", written), help));
}
Diagnostic not_a_channel(Span span, std::string const& function, std::string const& name, Names const& channels) {
  std::string help = name.empty() ? std::string() : did_you_mean(name, channels);
  if (help.empty()) {
    std::string known;
    for (std::string const& channel : channels) known += fmt::format("{}`{}`", known.empty() ? "" : ", ", channel);
    help = channels.empty() ? "declare a channel: `observe displacement ~ normal(y, sd = s)`" : "channels of this model: " + known;
  }
  return about(
      {function},
      error("E3105", span, fmt::format("the argument of `{}` must be the name of a channel, as written after `observe`", function),
            help));
}
Diagnostic samples_in_differential_equation(ast::Call const& call) {
  return about(
      {call.function.text},
      error("E3106", call.span,
            fmt::format("`{}` is known at samples only, but a differential equation needs it between them", call.function.text),
            "assign the column to an input with a rule between its samples, or declare `time discrete`"));
}
Diagnostic change_out_of_place(ast::Call const& call, bool discrete, bool no_states) {
  if (discrete)
    return about({call.function.text}, error("E3107", call.span, "`since_last` can be used only in continuous time",
                                             "write the difference: `y - lag(y, 1)`"));
  return about({call.function.text},
               error("E3107", call.span,
                     no_states ? "`since_last` needs consecutive rows, but this model has no states"
                               : "`since_last` can be used in `observe` and `derive`, but not in an equation",
                     no_states ? "without dynamics the rows are independent: add to the data a column that contains the change"
                               : "write the time derivative itself, as in `y' = -k*y`"));
}
Diagnostic own_sample(Span span, std::string const& channel) {
  return about({channel}, error("E3108", span, fmt::format("channel `{}` is predicted from its own present sample", channel),
                                fmt::format("use a past sample: `lag(measured({}), 1)`", channel)));
}
Diagnostic own_sample_in_function(Span call, std::string const& function, std::string const& channel) {
  return about(
      {function, channel},
      error("E3108", call, fmt::format("`{}` reads the present sample of `{}`, which it helps to predict", function, channel),
            fmt::format("use past samples: `lag(measured({0}), 1)`; a list of lags begins at 1, as in "
                        "`lags(measured({0}), 1..4)`",
                        channel)));
}
Diagnostic prediction_cycle(Span span, std::string const& channel) {
  return about({channel},
               error("E3109", span, fmt::format("the prediction of channel `{}` depends on itself at the same sample", channel),
                     fmt::format("use a past sample: `lag(predicted({}), 1)`", channel)));
}
Diagnostic present_prediction(Span span, std::string const& channel) {
  return about({channel}, error("E3110", span,
                                fmt::format("an equation cannot use the prediction of channel `{}` at the present sample", channel),
                                fmt::format("write out the expression of the channel, or use `lag(predicted({}), 1)`", channel)));
}
Diagnostic range_out_of_place(Span span) {
  return error("E3112", span, "a range is not allowed here", "a range selects lags: `lags(y, 1..3)`");
}
Diagnostic initial_lag_missing(Span declaration, std::string const& state) {
  return about(
      {state},
      error(
          "E3111", declaration, fmt::format("`{}` needs values before the first sample", state),
          fmt::format("give one value for all lags, `initial {} = 0`, or use the measured values: `initial {} = measured(CHANNEL)`",
                      state, state)));
}
Diagnostic implicit_in_discrete_time(Span equation, std::string const& state) {
  return about({state},
               error("E3113", equation, fmt::format("this equation cannot be solved for the present sample of `{}`", state),
                     fmt::format("make the equation linear in `{0}`, with past samples in the nonlinear terms: `{0} = a*lag({0}, "
                                 "1) - b*lag({0}, 1)^3`",
                                 state),
                     fmt::format("not linear in `{}`", state)));
}
Diagnostic forgotten_lag(Span equation, std::string const& state) {
  return as_warning(about(
      {state},
      error(
          "E3114", equation,
          fmt::format("`{0}` is used at the same sample on both sides, and no equation uses an earlier sample of `{0}`", state),
          fmt::format("if the sample before is meant, write `lag({0}, 1)` on the right; if not, solve for `{0}` by hand", state))));
}

Diagnostic prediction_without_lags(Span span, std::string const& model, bool random) {
  return about(
      {model},
      error("E6016", span, fmt::format("model `{}` is not in discrete time: it has no lagged samples", model),
            random ? "remove the option: with random states a fit predicts each sample from those before it; "
                     "`predict` has the option"
                   : "remove the option: a model in continuous time without random states is always simulated in a free run"));
}
Diagnostic nothing_measured_to_predict_from(Span span, std::string const& model) {
  return about({model},
               error("E6017", span, fmt::format("no channel of `{}` measures a quantity that the model uses with a lag", model),
                     "observe the lagged state itself, `observe output ~ normal(y, sd = s)`, or write `lag(measured(output), 1)`"));
}
Diagnostic other_step(Span span, double given, double declared, std::string const& model) {
  return about({model}, error("E6018", span,
                              fmt::format("the simulation has one sample every {:.9g} s, but model `{}` has steps of {:.9g} s",
                                          given, model, declared),
                              "remove the option, or make both steps equal"));
}

}  // namespace sysid::errors
