// The finding about residuals whose distribution differs from that of the noise of the model.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diagnostics/law/residual_law.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Of a channel.
struct LawWords {
  std::vector<std::string> names;                      // of the channel and its experiment
  std::string channel;                                 // as messages name it
  bool random_states;                                  // which noise with heavy tails does not go with
  std::function<bool(std::string const& name)> taken;  // whether a name stands in the text; may be empty
  std::string largest;                                 // "row 101, 5.2 sds; ...": the residuals far from most others, or none
  /// The statement of the channel's noise with heavy tails, and with a part that is proportional to the signal; nothing where it is
  /// not in the text.
  std::function<std::optional<std::string>()> heavy_tailed;
  std::function<std::optional<std::string>(std::string const& relative)> proportional;
};

/// `noise_law`, a warning, where residuals grow with the prediction or, if they do not, have heavy tails.
std::optional<Finding> noise_law(ResidualLaw const& law, double limit, LawWords const& words);

}  // namespace sysid
