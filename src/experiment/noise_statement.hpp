// The noise statement of a channel, as a user would change it.
#pragma once
#include <optional>
#include <string>

#include "core/text/source.hpp"
#include "model/model.hpp"

namespace sysid {

/// `observe displacement ~ normal(y + displacement_offset, sd = sigma)`: the statement of `channel` with `parameter` added to what
/// the noise lies about. Nothing where it is not in the text itself, but in a module.
std::optional<std::string> noise_statement_with(Source const& source, Channel const& channel, std::string const& parameter);

}  // namespace sysid
