// Flat syntax tree to checked file: names, kinds, units of literals, distributions, structure of the equations, data blocks, tasks.
#pragma once
#include <optional>

#include "check/checked/backends.hpp"
#include "check/checked/checked.hpp"
#include "check/elaborate/elaborate.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The checked file, or nothing when an error was reported. Warnings do not prevent a result.
std::optional<CheckedFile> check(Elaborated const& file, Backends const& backends, Diagnostics& diagnostics);

}  // namespace sysid
