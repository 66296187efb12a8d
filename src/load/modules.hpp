// Where `use hysteresis` finds its text: beside the file, else in the standard library, which the program carries in itself.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "check/elaborate/environment.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

struct LibraryModule {
  std::string_view name;
  std::string_view text;
};
/// Generated from stdlib/ by CMakeLists.txt, by name.
std::span<LibraryModule const> library_modules();

/// The text that stands in place of the file of that path, where there is one: an editor's, not saved yet.
using UnsavedText = std::function<std::optional<std::string>(std::string const& path)>;

/// The modules that a file uses, and those that these use, each once, behind what it uses; their texts join `source`, so spans mean
/// places in it. What is not found or cannot be parsed is reported. IoError when a file is there but cannot be read.
std::vector<Module> load_modules(ast::File const& file, Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved = {});

}  // namespace sysid
