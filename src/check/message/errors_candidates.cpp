// The checker's wording about candidate models, their selection and its distance.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {

Diagnostic candidate_twice(Span second, Span first, std::string const& model) {
  if (second == first)
    return about({model}, error("E6501", second, fmt::format("`{}` is twice among the models that this stands for", model),
                                "name every number once"));
  return about({model}, conflict("E6501", second, "again", first, "first here",
                                 fmt::format("`{}` is a candidate twice: its probability would be counted twice", model),
                                 "name every model once"));
}

Diagnostic probabilities(ast::Name const& set, double sum, int open, int models) {
  if (open > 0)
    return error("E6502", set.span,
                 fmt::format("the probabilities given here sum to {:.10g}: nothing is left for {}", sum,
                             open == 1 ? std::string("the last model") : fmt::format("the {} models without one", open)),
                 "a probability is that of each model that its candidate stands for; models without one share what is left");
  return error("E6502", set.span, fmt::format("the probabilities of these {} models sum to {:.10g}, not to 1", models, sum),
               "a probability is that of each model that its candidate stands for; models without one share what is left");
}

Diagnostic not_a_probability(Span span, double value) {
  return error(
      "E6503", span, fmt::format("a prior probability lies above 0 and at most at 1, here it is {:.10g}", value),
      value == 0 ? "leave the candidate out" : "correct the number, or leave it out: models without one share what is left");
}

Diagnostic shared_by_none(ast::Name const& name, std::string const& set, Names const& known) {
  return about({set, name.text}, error("E6504", name.span, fmt::format("no candidate of `{}` has a parameter `{}`", set, name.text),
                                       guess_or(name.text, known, choose(known, "parameter"))));
}

Diagnostic shared_by_one(ast::Name const& name, std::string const& model) {
  return about({name.text, model},
               error("E6504", name.span, fmt::format("`{}` is a parameter of one candidate alone, `{}`", name.text, model),
                     "leave it out here, or give the parameter the same name in the other models"));
}

Diagnostic shared_parameter_differs(ast::Name const& name, Span first, std::string const& one, Span other, std::string const& model,
                                    bool same_unit) {
  Diagnostic result =
      about({name.text, one, model},
            error("E6505", name.span,
                  fmt::format("`{}` has not the same {} in `{}` and in `{}`", name.text, same_unit ? "prior" : "unit", one, model),
                  same_unit ? "give it one prior, or leave it out of what is shared"
                            : "give it one unit, or leave it out of what is shared"));
  result.secondary.push_back({first, fmt::format("in {}", one)});
  result.secondary.push_back({other, fmt::format("in {}", model)});
  return result;
}

Diagnostic no_candidates(ast::Name const& set) {
  return about({set.text}, error("E6506", set.span, fmt::format("`{}` holds no model", set.text),
                                 "name one model a line: `linear`, `bouc_wen(n = 1..4)`"));
}

Diagnostic candidate_without_channel(Span candidate, std::string const& model, Span channel, std::string const& other,
                                     std::string const& name) {
  return about(
      {other, name, model},
      conflict("E6507", candidate, "does not observe it", channel, fmt::format("of {}", other),
               fmt::format("`{}` observes `{}`, which the data measure, and `{}` does not: their distances could not be compared",
                           other, name, model),
               fmt::format("add `observe {} ~ ...` to it, or leave the column out of the data", name)));
}

Diagnostic channel_of_two_units(Span one, std::string const& model, Unit const& unit, Span other, std::string const& other_model,
                                Unit const& other_unit, std::string const& name) {
  return about({name, other_model, model},
               conflict("E6508", one, measure(unit), other, measure(other_unit),
                        fmt::format("`{}` is not the same quantity in `{}` and in `{}`", name, other_model, model),
                        "let all candidates observe it in units of one kind"));
}

Diagnostic distance_choice(Span span, std::string const& given, std::string const& channel) {
  return about({given},
               error("E6006", span, fmt::format("`distance` cannot be `{}`", given),
                     guess_or(given, {"nmse", "rmse"},
                              fmt::format("choose `nmse`, `rmse` or an expression such as `abs(residual({}))`", channel))));
}

Diagnostic distance_reads(Span span, std::string const& name) {
  return about(
      {name},
      error("E6509", span, fmt::format("a distance cannot read `{}`", name),
            "it means the same in every candidate: it reads `measured`, `predicted` and `residual` of a channel, and numbers"));
}

Diagnostic distance_of_one_channel(Span span, Names const& channels, std::string const& example) {
  if (channels.empty())
    return error("E6510", span, "this distance reads no channel", fmt::format("for example `abs(residual({}))`", example));
  return error("E6510", span, fmt::format("this distance reads {}", quoted(channels)),
               "write one expression for each channel, in a list: `(abs(residual(a)), abs(residual(b)))`");
}

Diagnostic distance_may_be_negative(Span span, std::string const& expression) {
  return error("E6511", span, "this distance may be negative",
               expression.size() < 40 ? fmt::format("take `abs({})`, or a square", expression)
                                      : "take its absolute value with `abs(...)`, or a square");
}

Diagnostic distance_lacks_channel(Span span, std::string const& channel) {
  return about({channel}, error("E6512", span, fmt::format("this distance leaves out `{}`, which the data measure", channel),
                                fmt::format("add an expression for it to the list, or `weights({} = 0)`", channel)));
}

Diagnostic distances_of_two_kinds(Span span, std::string const& one, Unit const& unit, std::string const& other,
                                  Unit const& other_unit) {
  return about(
      {one, other},
      error("E6513", span, fmt::format("`rmse` cannot add `{}` {} and `{}` {}", one, measure(unit), other, measure(other_unit)),
            "take `nmse`, which has no unit, or give one of them no weight: `weights(" + other + " = 0)`"));
}

Diagnostic expressions_of_two_units(Span second, Unit const& unit, Span first, Unit const& first_unit) {
  return conflict("E6513", second, measure(unit), first, measure(first_unit),
                  "these distances have different units, so that they have no mean", "divide each by a size of its channel");
}

Diagnostic no_weight(Span span) {
  return error("E6514", span, "every channel has weight 0: nothing would be compared", "give one of them a positive weight");
}

Diagnostic backend_of_other_verb(ast::Name const& name, std::string const& verb, std::string const& own, Names const& known) {
  if (verb == "select" && own == "fit")
    return about({name.text},
                 error("E6515", name.span, fmt::format("`{}` fits one model, it does not select among several", name.text),
                       fmt::format("select with {}, or `fit` one model with `{}`", quoted(known, "or"), name.text)));
  if (own == "select")
    return about({name.text, verb},
                 error("E6515", name.span, fmt::format("`{}` selects among models, it is not for `{}`", name.text, verb),
                       fmt::format("write `select MODEL to DATA with {}`, or {} with {}", name.text, verb, quoted(known, "or"))));
  return about({name.text, verb}, error("E6515", name.span,
                                        fmt::format("`{}` {}, it is not for `{}`", name.text,
                                                    own == "fit" ? "fits a model" : "finds terms of a dictionary", verb),
                                        fmt::format("{} with {}", verb, quoted(known, "or"))));
}

Diagnostic arguments_of_candidates(Span span, std::string const& set) {
  return about({set}, error("E6516", span, fmt::format("`{}` is a set of candidates and takes no arguments", set),
                            "give them to the models in the set: `bouc_wen(n = 1..4)`"));
}

Diagnostic model_and_candidates(ast::Name const& name, Span model) {
  return about({name.text}, conflict("E3013", name.span, "a set of candidates", model, "a model",
                                     fmt::format("a task could mean two things by `{}`", name.text), "rename one of the two"));
}

}  // namespace sysid::errors
