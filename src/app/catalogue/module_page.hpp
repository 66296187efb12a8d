// Pages of the standard library, made of its own comments and declarations: `sysid document hysteresis`, docs/stdlib/.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "load/modules.hpp"

namespace sysid {

/// The first line of the module's comment.
std::string module_summary(LibraryModule const& module);

/// The page of a module as Markdown: its comment; of each model the comment, the names with units and priors, the text, and an
/// example that the checker accepts. Nothing when there is no such module.
std::optional<std::string> module_page(std::string_view name);

}  // namespace sysid
