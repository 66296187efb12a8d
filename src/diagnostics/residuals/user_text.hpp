// The user's text, as the help of findings quotes it.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "model/model.hpp"

namespace sysid {

/// What the user's text says, of which a model has only the meaning.
struct TimeName {
  std::string text = "t";
  bool declared = false;
};

struct UserText {
  /// Whether the name stands anywhere in it.
  std::function<bool(std::string const& name)> mentions;
  /// The noise statement of a channel with `sum` added to what the noise lies about; nothing where it is not in the text.
  std::function<std::optional<std::string>(Channel const& channel, std::string const& sum)> noise_statement_with;
  /// What the model of a channel calls the time, or could.
  std::function<TimeName(Channel const& channel)> time_name = {};
  /// The same with heavy tails, and with a part of the noise that is proportional to what it lies about, as `relative` times that.
  std::function<std::optional<std::string>(Channel const& channel)> heavy_tailed = {};
  std::function<std::optional<std::string>(Channel const& channel, std::string const& relative)> proportional = {};
  /// The same of counts that scatter more than Poisson's, by a negative binomial of this shape.
  std::function<std::optional<std::string>(Channel const& channel, std::string const& shape)> overdispersed = {};
};

}  // namespace sysid
