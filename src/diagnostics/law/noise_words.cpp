// The user's own statement, changed, where it is known; else what to write in its place.
#include "diagnostics/law/noise_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sysid {

std::function<bool(std::string const& name)> taken_names(Model const& model,
                                                         std::function<bool(std::string const& name)> mentions) {
  return [&model, mentions = std::move(mentions)](std::string const& name) {
    auto const has = [&](auto const& quantities) {
      return std::ranges::any_of(quantities, [&](auto const& each) { return each.name == name; });
    };
    return (mentions && mentions(name)) || has(model.parameters) || has(model.states) || has(model.inputs) || has(model.channels) ||
           has(model.derived);
  };
}

std::string use_heavy_tails(std::optional<std::string> const& line) {
  return "use noise with heavy tails, " + (line ? "`" + *line + "`" : std::string("`student_t` in place of `normal`"));
}

std::string use_overdispersed(std::string const& shape, std::optional<std::string> const& line) {
  std::string const noise =
      line ? fmt::format("add `parameter {} [-] ~ log_uniform(0.1, 1000)` and write `{}`", shape, *line)
           : fmt::format(
                 "use `negative_binomial` with the same mean and `shape = {}`, a parameter with a prior, in place of `poisson`",
                 shape);
  return "the counts scatter more than `poisson` noise, or the model is incomplete: " + noise + ", then check the residuals";
}

}  // namespace sysid
