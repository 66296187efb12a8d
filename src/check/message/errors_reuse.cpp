// The wording of messages about reuse. Lower case without a full stop; `help` states what to do.
#include "check/message/errors_reuse.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "check/message/error_words.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

Diagnostic with(Diagnostic diagnostic, Span other, std::string label) {
  diagnostic.secondary.push_back({other, std::move(label)});
  return diagnostic;
}

}  // namespace

Diagnostic whole_number_needed(Span span, Subject const& what) {
  return about(what.names, error("E2701", span, fmt::format("{} must be a constant whole number", what.words),
                                 "use numbers and arguments of the model: `3`, `n`, `n - 1`"));
}
Diagnostic size_out_of_range(Span span, std::string const& name, long size, long most) {
  return about({name}, error("E2702", span, fmt::format("`{}` cannot have {} elements", name, size),
                             fmt::format("a size must be from 1 to {}", most)));
}
Diagnostic too_many_sizes(Span span, std::string const& name) {
  return about({name}, error("E2703", span, fmt::format("`{}` has more than two dimensions", name),
                             "a vector is `q(3)`, a matrix `M(3, 3)`"));
}
Diagnostic shape_conflict(Span span, std::string const& symbol, Shape const& left, Span left_span, Shape const& right,
                          Span right_span) {
  std::string help = "give both sides the same shape; a scalar applies to every element";
  std::string what = fmt::format("`{}` is not defined between {} and {}", symbol, left.text(), right.text());
  if (symbol == "*") {
    help = left.rank == 1 && right.rank == 1
               ? "`dot(a, b)` is the sum of products, `diagonal(a)*b` multiplies element by element, `a*transpose(b)` is a matrix"
               : "the left side must have as many columns as the right side has rows";
  } else if (symbol == "=") {
    what = fmt::format("{} cannot equal {}", left.text(), right.text());
    help = "both sides of a vector equation must be vectors, or one side must be 0";
  } else if (symbol == "^") {
    help =
        "only numbers and vectors can be raised to a power, element by element, and the exponent must be a number; for a matrix "
        "write a product: `A*A`";
  } else if (symbol == "/") {
    help = right.rank == 2  ? "the divisor must be a number: solve for a vector by an equation, `A*v = b`"
           : left.rank == 0 ? "the divisor must be a number; write `a*b^-1`: `b^-1` are the reciprocals of all elements"
                            : "the divisor must be a number; to divide element by element write `diagonal(a)*b^-1`";
  } else if (symbol == "dot") {
    help = "`dot` takes two vectors of one size";
  }
  Diagnostic result = error("E2704", left_span, std::move(what), std::move(help), left.text());
  if (left_span == right_span) result.primary = Label{span, {}};
  return left_span == right_span ? result : with(std::move(result), right_span, right.text());
}
Diagnostic wrong_shape(Span span, Subject const& what, Shape const& given, Shape const& wanted) {
  return about(what.names,
               error("E2705", span, fmt::format("{} is {}, but {} is needed", what.words, given.text(), wanted.text()),
                     wanted.rank == 0 ? "use one element, `q[1]`, or a sum, `sum(q)`; or declare the size after the name: `name(3)`"
                                      : "write a list in parentheses with that many items, or one number for all"));
}
Diagnostic list_of_initial(Span span, ast::Reference const& state, Shape const& given) {
  Diagnostic result = wrong_shape(span, named("the initial value of", primed(state)), given, Shape{});
  result.help = fmt::format("each initial value has a state of its own: `initial {0} = 0, {0}' = 0`", primed(state));
  return result;
}
Diagnostic uneven_list(Span span, Shape const& first, Shape const& other, Span other_span) {
  return with(error("E2706", span, "the items of this list have different shapes", "a matrix is a list of rows of equal length",
                    fmt::format("begins with {}", first.text())),
              other_span, other.text());
}
Diagnostic index_out_of_range(Span span, std::string const& name, Shape const& shape) {
  return about({name}, error("E2707", span, fmt::format("`{}` is {}: it has no such element", name, shape.text()),
                             "elements are numbered from 1"));
}
Diagnostic index_count(Span span, std::string const& name, Shape const& shape, std::size_t given) {
  return about({name},
               error("E2707", span,
                     fmt::format("`{}` is {}, but {} {} given", name, shape.text(), given, given == 1 ? "index is" : "indices are"),
                     shape.rank == 0   ? fmt::format("remove the index, or declare `{}(n)`", name)
                     : shape.rank == 1 ? fmt::format("write `{}[i]`", name)
                                       : fmt::format("write `{}[i, j]`: row and column", name)));
}
Diagnostic array_arguments(ast::Name const& function, std::size_t given, std::string const& usage) {
  if (function.text == "dot" && given == 1)
    return about({function.text}, error("E2708", function.span, "`dot` multiplies two vectors and is not a derivative",
                                        "a derivative is written with primes: `y'`, `y''`"));
  return about({function.text},
               error("E2708", function.span, fmt::format("`{}` does not take these arguments", function.text), usage));
}
Diagnostic model_too_large(Span span) {
  return error("E2709", span, "this model is too large when its vectors and parts are written out",
               "make vectors and matrices smaller, or nest fewer parts and functions");
}

Diagnostic models_too_large(Span span) {
  return error("E2709", span, "the models of this file are too large when their vectors and parts are written out",
               "move this model and those below it to another file, or use fewer models with large arguments");
}

Diagnostic part_cycle(Span span, Names const& loop) {
  return error("E2801", span, fmt::format("this model is a part of itself: {}", fmt::join(loop, " -> ")),
               "remove the cycle: move what both need into a third model");
}
Diagnostic model_argument_missing(Span span, std::string const& model, std::string const& argument) {
  return about({model, argument}, error("E2802", span, fmt::format("model `{}` needs its argument `{}`", model, argument),
                                        fmt::format("write `{}({} = 2)`, or give `{}` a default where the model is defined", model,
                                                    argument, argument)));
}
Diagnostic unknown_model_argument(ast::Name const& name, std::string const& model, Names const& known) {
  return about({model, name.text},
               error("E2803", name.span, fmt::format("model `{}` has no argument `{}`", model, name.text),
                     guess_or(name.text, known, known.empty() ? "it takes none" : fmt::format("it takes {}", quoted(known)))));
}
Diagnostic model_argument_by_position(std::span<ast::Argument const> arguments, std::size_t& i, std::string const& model,
                                      Names const& known) {
  std::size_t const first = i;
  while (i + 1 < arguments.size() && !arguments[i + 1].name) ++i;
  Names open = known;
  for (ast::Argument const& each : arguments)
    if (each.name) std::erase(open, each.name->text);
  std::string help = known.empty() ? "it takes none" : open.empty() ? "remove it" : fmt::format("write `{} = ...`", open.front());
  if (first > 0 && std::holds_alternative<ast::Number>(arguments[first - 1].value.node)) {  // of `n = 1, 2, 3`
    Names values;
    for (std::size_t k = first - 1; k <= i; ++k) values.push_back(unparse(arguments[k].value));
    help = fmt::format("several values of one argument stand in parentheses: `{} = ({})`", arguments[first - 1].name->text,
                       fmt::join(values, ", "));
  }
  return about({model}, error("E2804", arguments[first].span,
                              fmt::format("the arguments of model `{}` must be given by name", model), std::move(help)));
}
Diagnostic model_argument_twice(Span second, Span first, std::string const& name) {
  return with(about({name}, error("E2805", second, fmt::format("`{}` is given twice", name), "keep one", "again here")), first,
              "first here");
}
Diagnostic input_of_part_unbound(Span span, std::string const& part, Names const& inputs, std::string const& model) {
  return also_about(
      inputs,
      about({part}, error("E2806", span,
                          fmt::format("part `{}` has no value for its {} {}", part, plural("input", inputs.size()), quoted(inputs)),
                          fmt::format("assign a value to it: `{}({} = ...)`", model, inputs.front()))));
}
Diagnostic no_rate_of_binding(Span use, Span binding, std::string const& input) {
  return with(
      about({input},
            error("E2807", binding,
                  fmt::format(
                      "the part needs the time derivative of its input `{}`, but the program cannot differentiate this expression",
                      input),
                  "give a state, an input, or sums, products, quotients and constant powers of these")),
      use, "the derivative is used here");
}
Diagnostic candidate_range(Span span, long models, std::size_t most) {
  return error("E2809", span,
               models < 1 ? "this range is empty: it ends before it begins"
                          : fmt::format("this line has {} models, more than a set can contain", models),
               models < 1 ? "write the smaller number first: `1..4`" : fmt::format("keep at most {}", most));
}
Diagnostic discrete_part(Span span, std::string const& part, Span declaration) {
  return with(about({part}, error("E2808", span, fmt::format("part `{}` is in discrete time, but the model around it is not", part),
                                  "declare `time discrete` in both, or in neither")),
              declaration, "declared here");
}

Diagnostic process_of_part(Span span, std::string const& part, Span declaration) {
  return with(
      about({part},
            error("E3215", span, fmt::format("part `{}` declares an unknown function, `~ gp(...)`, which a part cannot have", part),
                  "declare the function in the model around the part, and use it there")),
      declaration, "declared here");
}

Diagnostic module_not_found(ast::Name const& module, std::string const& folder, Names const& known) {
  Diagnostic result =
      about({module.text}, error("E2901", module.span,
                                 fmt::format("there is no `{}.sysid` in {} and no module `{}` in the standard library", module.text,
                                             folder, module.text),
                                 guess_or(module.text, known, "`sysid list modules` lists the standard library")));
  result.prompt_help = guess_or(module.text, known, "`list modules` lists the standard library");
  return result;
}
Diagnostic module_cycle(Span span, Names const& loop) {
  return error("E2902", span, fmt::format("this module uses itself: {}", fmt::join(loop, " -> ")),
               "move what both need into a third module");
}
Diagnostic name_of_two_modules(Span second, Span first, std::string const& kind, std::string const& name) {
  return with(about({name}, error("E2903", second, fmt::format("there are two {}s named `{}` here", kind, name),
                                  "rename one of the two", "this one")),
              first, "and this one");
}
Diagnostic not_for_a_module(Span span, std::string const& what, std::string const& module) {
  return about({module}, error("E2904", span, fmt::format("{} is not allowed in module `{}`", what, module),
                               "a module contains models and functions only; move it to the file that uses them"));
}

}  // namespace sysid::errors
