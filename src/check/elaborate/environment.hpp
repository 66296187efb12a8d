// Which models and functions a file may name: its own, and those of the modules it uses.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// A module that was read: `use` statements refer to it by name. from_library: shipped with the program, so it is known to be
/// sound.
struct Module {
  std::string name;
  ast::File tree;
  bool from_library = false;
};

struct Environment;
struct ModelEntry {
  ast::Model const* tree = nullptr;
  Environment const* home = nullptr;  // whose names its text means
};
struct FunctionEntry {
  ast::FunctionDefinition const* tree = nullptr;
  Environment const* home = nullptr;
};
struct Environment {
  std::string module;  // empty: the file itself
  bool from_library = false;
  std::map<std::string, ModelEntry> models;
  std::map<std::string, FunctionEntry> functions;
};

/// The environments of a file and of all modules; what a module may not hold and names that clash are reported.
class Environments {
 public:
  Environments(ast::File const& file, std::vector<Module> const& modules, Diagnostics& diagnostics);
  Environment const& main() const { return all_.at(""); }
  std::map<std::string, Environment> const& all() const { return all_; }

 private:
  void own(Environment& environment, ast::File const& tree, Diagnostics& diagnostics);
  void import(Environment& environment, ast::File const& tree, Diagnostics& diagnostics);

  std::map<std::string, Environment> all_;
};

}  // namespace sysid
