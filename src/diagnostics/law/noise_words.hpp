// Help that changes the noise of a channel, in words that several findings share.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "core/text/free_name.hpp"
#include "model/model.hpp"

namespace sysid {

/// Names that a cure may not give to something new: those of the model, which outlives the answer, and those that stand in the
/// user's text. mentions: of the latter; may be empty.
std::function<bool(std::string const& name)> taken_names(Model const& model, std::function<bool(std::string const& name)> mentions);

/// line: the statement of the channel's noise with heavy tails; nothing where it is not in the text.
std::string use_heavy_tails(std::optional<std::string> const& line);

/// Of counts with Poisson noise that scatter more than it. line: their statement with a negative binomial of this shape; nothing
/// where it is not in the text.
std::string use_overdispersed(std::string const& shape, std::optional<std::string> const& line);

}  // namespace sysid
