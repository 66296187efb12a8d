// Cures that change the noise of a channel, in the words that several findings share.
#pragma once
#include <functional>
#include <optional>
#include <string>

namespace sysid {

/// A name that does not stand in the text: the wanted one, with what cannot be part of a name replaced, or that with numbers.
std::string free_name(std::string wanted, std::function<bool(std::string const& name)> const& taken);

/// line: the statement of the channel's noise with heavy tails; nothing where it is not in the text.
std::string use_heavy_tails(std::optional<std::string> const& line);

/// Of counts with Poisson noise that scatter more than it. line: their statement with a negative binomial of this shape; nothing
/// where it is not in the text.
std::string use_overdispersed(std::string const& shape, std::optional<std::string> const& line);

}  // namespace sysid
