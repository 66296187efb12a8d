// Flat syntax tree to checked file: names, kinds, units of literals, distributions, structure of the equations, data blocks, tasks.
#pragma once
#include <optional>
#include <span>

#include "check/checked.hpp"
#include "check/elaborate/elaborate.hpp"
#include "core/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// A back end as tasks may name it: the checker knows its settings, nothing else.
struct BackendSettings {
  std::string_view name;
  std::span<SettingRow const> settings;
};

/// Those that a file's tasks may name.
struct Backends {
  std::span<BackendSettings const> fitting;
  std::span<BackendSettings const> selecting;
  std::span<BackendSettings const> discovering;  // selectors of terms, the first is the default
  std::span<BackendSettings const> derivatives;  // forms of derivatives for discovery, likewise
};

/// The checked file, or nothing when an error was reported. Warnings do not prevent a result.
std::optional<CheckedFile> check(Elaborated const& file, Backends const& backends, Diagnostics& diagnostics);

}  // namespace sysid
