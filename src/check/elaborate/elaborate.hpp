// Syntax tree to flat syntax tree: models with their arguments, parts and modules put in, vectors and matrices written out in
// numbers. The checker behind it sees numbers only; spans still point to what the user wrote, in whichever file.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "check/elaborate/environment.hpp"

namespace sysid {

/// What the flat tree does not say about its models.
struct Lineage {
  std::map<std::string, std::vector<std::string>> made_of;  // by name: the models whose mistakes would be found again in this one
  std::set<std::string> failed;                             // names without a model in the tree, since a message was given
  std::set<std::string> only_checked;                       // looked at, but nothing in the file uses them
};

struct Elaborated {
  ast::File tree;
  Lineage lineage;
};

/// Models that fail are left out and named in the lineage; whatever does not use them can still be checked.
Elaborated elaborate(ast::File const& file, std::vector<Module> const& modules, Diagnostics& diagnostics);

}  // namespace sysid
