// The checker's wording about predictions that average over several fits.
#include <fmt/format.h>

#include "check/message/error_words.hpp"

namespace sysid::errors {

Diagnostic averaged_twice(ast::Name const& second, Span first) {
  return about({second.text},
               conflict("E6701", second.span, "again", first, "first here",
                        fmt::format("`{}` is named twice: its weight would count twice", second.text), "name each fit once"));
}

Diagnostic selection_in_average(ast::Name const& name) {
  return about({name.text},
               error("E6702", name.span, fmt::format("`{}` is a selection and cannot be averaged with fits", name.text),
                     fmt::format("a prediction from a selection averages over its candidates already: `predict {} on "
                                 "...`; to average by evidence, fit each candidate and name these fits",
                                 name.text)));
}

Diagnostic weights_of_one_fit(Span option, std::string const& subject) {
  return about({"weights", subject},
               error("E6703", option, fmt::format("`weights` needs several fits, but `{}` is predicted alone", subject),
                     fmt::format("name the other fits: `predict {}, ANOTHER_FIT on ...`; or remove `weights`", subject)));
}

Diagnostic fit_without_weight(ast::Name const& fit, std::string const& backend, std::string const& reason,
                              std::string const& help) {
  return about({fit.text, backend},
               error("E6704", fit.span, fmt::format("`{}` cannot be given a weight: {}", fit.text, reason), help));
}

Diagnostic average_without_channel(ast::Name const& fit, std::string const& channel, std::string const& other,
                                   std::string const& data) {
  return about({fit.text, channel, other, data},
               error("E6706", fit.span,
                     fmt::format("the model of `{}` does not observe `{}`, which data block `{}` measures and fit `{}` predicts",
                                 fit.text, channel, data, other),
                     fmt::format("an average needs every measured channel from all its fits: add `observe {} ~ ...` to the model, "
                                 "or predict on data without this channel",
                                 channel)));
}

Diagnostic average_of_two_units(ast::Name const& fit, Unit const& unit, std::string const& channel, std::string const& other,
                                Unit const& other_unit) {
  return about({fit.text, channel, other},
               error("E6706", fit.span,
                     fmt::format("`{1}` is {2} in `{0}`, but {4} in `{3}`: it is not the same quantity", fit.text, channel,
                                 measure(unit), other, measure(other_unit)),
                     zero_against_difference(unit, other_unit) ? "observe the temperature or a difference of two in all models"
                                                               : "observe it in units of the same dimension in all models"));
}

Diagnostic average_redrawn(Span option) {
  return error("E6519", option, "parameters cannot be redrawn at each step if the trajectories belong to different models",
               "remove `redraw = step`");
}

}  // namespace sysid::errors
