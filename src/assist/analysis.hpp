// A text as an editor holds it, read as far as it can be: its tree with modules, its names, and what is wrong with it.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assist/symbols.hpp"
#include "core/text/diagnostic.hpp"
#include "load/modules.hpp"

namespace sysid::assist {

/// What a text says, without judging it.
struct Reading {
  Source source;
  ast::File tree;
  std::vector<Module> modules;
  SymbolTable names;
  bool complete = false;  // nothing was left out of the tree
};

/// path: of the file, for modules and data beside it; it need not exist. Statements that cannot be read are left out, an open block
/// at the end is closed. Nothing when even so there is no tree.
std::shared_ptr<Reading const> read(std::string const& path, std::string const& text, UnsavedText const& unsaved = {});

/// The messages of `sysid check` about the text and its data, with the texts that their spans mean.
struct Analysis {
  Source source;
  Diagnostics diagnostics;
};
Analysis analyse(std::string const& path, std::string const& text, UnsavedText const& unsaved = {});

}  // namespace sysid::assist
