// The checker's wording about candidate models, their selection and its distance.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {

Diagnostic candidate_twice(Span second, Span first, std::string const& model) {
  if (second == first)
    return about({model}, error("E6501", second, fmt::format("`{}` is listed twice on this line", model), "list each number once"));
  return about({model}, conflict("E6501", second, "again", first, "first here",
                                 fmt::format("`{}` is listed as a candidate twice: its probability would count twice", model),
                                 "list each model once"));
}

Diagnostic probabilities(ast::Name const& set, double sum, int open, int models) {
  if (open > 0)
    return error("E6502", set.span,
                 fmt::format("the probabilities given here sum to {:.10g}: no probability remains for {}", sum,
                             open == 1 ? std::string("the model without a stated probability")
                                       : fmt::format("the {} models without a stated probability", open)),
                 "a probability written on a line applies to each model of that line; models without one share the rest");
  return error("E6502", set.span, fmt::format("the probabilities of these {} models sum to {:.10g}, not to 1", models, sum),
               "a probability written on a line applies to each model of that line; models without one share the rest");
}

Diagnostic not_a_probability(Span span, double value) {
  return error(
      "E6503", span, fmt::format("a prior probability must be above 0 and at most 1, but this is {:.10g}", value),
      value == 0
          ? "remove the candidate"
          : "give a number above 0 and at most 1, or remove the probability: models without a stated probability share the rest");
}

Diagnostic shared_by_none(ast::Name const& name, std::string const& set, Names const& known) {
  return about({set, name.text}, error("E6504", name.span, fmt::format("no candidate of `{}` has a parameter `{}`", set, name.text),
                                       guess_or(name.text, known, choose(known, "parameter"))));
}

Diagnostic shared_by_one(ast::Name const& name, std::string const& model) {
  return about({name.text, model},
               error("E6504", name.span, fmt::format("`{}` is a parameter of only one candidate, `{}`", name.text, model),
                     "remove it here, or give the parameter the same name in the other models"));
}

Diagnostic shared_parameter_differs(ast::Name const& name, Span first, std::string const& one, Span other, std::string const& model,
                                    bool same_unit) {
  Diagnostic result = about(
      {name.text, one, model},
      error("E6505", name.span,
            fmt::format("`{}` does not have the same {} in `{}` and in `{}`", name.text, same_unit ? "prior" : "unit", one, model),
            same_unit ? "give it the same prior in both, or remove it from `shared`"
                      : "give it the same unit in both, or remove it from `shared`"));
  result.secondary.push_back({first, fmt::format("in {}", one)});
  result.secondary.push_back({other, fmt::format("in {}", model)});
  return result;
}

Diagnostic no_candidates(ast::Name const& set) {
  return about({set.text}, error("E6506", set.span, fmt::format("`{}` contains no model", set.text),
                                 "write one model per line: `linear`, `bouc_wen(n = 1..4)`"));
}

Diagnostic candidate_without_channel(Span candidate, std::string const& model, Span channel, std::string const& other,
                                     std::string const& name) {
  return about({other, name, model},
               conflict("E6507", candidate, "does not observe it", channel, fmt::format("of {}", other),
                        fmt::format("`{}` observes the measured channel `{}`, but `{}` does not: they cannot be compared", other,
                                    name, model),
                        fmt::format("add `observe {} ~ ...` to it, or remove the column from the data block", name)));
}

Diagnostic channel_of_two_units(Span one, std::string const& model, Unit const& unit, Span other, std::string const& other_model,
                                Unit const& other_unit, std::string const& name) {
  return about(
      {name, other_model, model},
      conflict("E6508", one, measure(unit), other, measure(other_unit),
               fmt::format("`{}` is not the same quantity in `{}` and in `{}`", name, other_model, model),
               zero_against_difference(unit, other_unit) ? "observe the temperature or a difference of two in all candidates"
                                                         : "observe it in units of the same dimension in all candidates"));
}

Diagnostic distance_choice(Span span, std::string const& given, std::string const& channel) {
  return about({given, "distance"},
               error("E6006", span, fmt::format("`distance` cannot be `{}`", given),
                     guess_or(given, {"nmse", "rmse"},
                              fmt::format("choose `nmse`, `rmse` or an expression such as `abs(residual({}))`", channel))));
}

Diagnostic distance_reads(Span span, std::string const& name) {
  return about({name},
               error("E6509", span, fmt::format("a distance cannot depend on `{}`", name),
                     "use only what every candidate has: `measured`, `predicted` and `residual` of a channel, and numbers"));
}

Diagnostic distance_of_one_channel(Span span, Names const& channels, std::string const& example) {
  if (channels.empty())
    return error("E6510", span, "this distance uses no channel", fmt::format("for example `abs(residual({}))`", example));
  return about(channels, error("E6510", span, fmt::format("this distance uses more than one channel: {}", quoted(channels)),
                               "write one expression for each channel, in a list: `(abs(residual(a)), abs(residual(b)))`"));
}

Diagnostic distance_may_be_negative(Span span, std::string const& expression) {
  return error("E6511", span, "this distance may be negative",
               expression.size() < 40 ? fmt::format("use `abs({})`, or a square", expression)
                                      : "use its absolute value, `abs(...)`, or a square");
}

Diagnostic distance_lacks_channel(Span span, std::string const& channel) {
  return about({channel}, error("E6512", span, fmt::format("this distance does not include the measured channel `{}`", channel),
                                fmt::format("add an expression for it to the list, or `weights({} = 0)`", channel)));
}

Diagnostic distances_of_two_kinds(Span span, std::string const& one, Unit const& unit, std::string const& other,
                                  Unit const& other_unit) {
  return about({one, other, "rmse"},
               error("E6513", span,
                     fmt::format("`rmse` cannot add `{}`, which is {}, and `{}`, which is {}", one, measure(unit), other,
                                 measure(other_unit)),
                     "use `nmse`, which has no unit, or give one of them weight 0: `weights(" + other + " = 0)`"));
}

Diagnostic expressions_of_two_units(Span second, Unit const& unit, Span first, Unit const& first_unit) {
  return conflict("E6513", second, measure(unit), first, measure(first_unit),
                  "these distances have different units and cannot be averaged", "divide each by a typical value of its channel");
}

Diagnostic no_weight(Span span) {
  return error("E6514", span, "every channel has weight 0: nothing would be compared", "give one of them a positive weight");
}

Diagnostic backend_of_other_verb(ast::Name const& name, std::string const& verb, TaskKind own, Names const& known) {
  if (words::task_kind(verb) == TaskKind::select && own == TaskKind::fit)
    return about({name.text},
                 error("E6515", name.span, fmt::format("`{}` fits a single model and cannot select among several", name.text),
                       fmt::format("select with {}, or `fit` one model with `{}`", quoted(known, "or"), name.text)));
  if (own == TaskKind::select)
    return about({name.text, verb},
                 error("E6515", name.span, fmt::format("`{}` selects among models and cannot be used with `{}`", name.text, verb),
                       fmt::format("write `select MODEL to DATA with {}`, or {} with {}", name.text, verb, quoted(known, "or"))));
  return about({name.text, verb}, error("E6515", name.span,
                                        fmt::format("`{}` {} and cannot be used with `{}`", name.text,
                                                    own == TaskKind::fit ? "fits a model" : "finds terms of a dictionary", verb),
                                        fmt::format("{} with {}", verb, quoted(known, "or"))));
}

Diagnostic arguments_of_candidates(Span span, std::string const& set) {
  return about({set}, error("E6516", span, fmt::format("`{}` is a set of candidates and takes no arguments", set),
                            "give them to the models in the set: `bouc_wen(n = 1..4)`"));
}

Diagnostic model_and_candidates(ast::Name const& name, Span model) {
  return about({name.text},
               conflict("E3013", name.span, "a set of candidates", model, "a model",
                        fmt::format("`{}` is the name of a model and of a set of candidates", name.text), "rename one of the two"));
}

}  // namespace sysid::errors
