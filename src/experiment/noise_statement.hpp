// The noise statement of a channel, as a user would change it.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "core/text/source.hpp"
#include "model/model.hpp"

namespace sysid {

/// Whether the name stands anywhere in the text, comments included.
bool mentions(Source const& source, std::string_view name);

/// `observe displacement ~ normal(y + displacement_offset, sd = sigma)`: the statement of `channel` with `parameter` added to what
/// the noise lies about. Nothing where it is not in the text itself, but in a module.
std::optional<std::string> noise_statement_with(Source const& source, Channel const& channel, std::string const& parameter);

}  // namespace sysid
