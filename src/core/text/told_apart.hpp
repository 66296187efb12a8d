// Distinct file names from the user's names, some of which become the same when characters are left out.
#pragma once
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

/// The names, in their order: of equal ones the first stays as it is, each other gets `_` at its end until no name is like it.
inline std::vector<std::string> told_apart(std::vector<std::string> names) {
  std::set<std::string> taken(names.begin(), names.end()), seen;
  for (std::string& name : names) {
    if (seen.insert(name).second) continue;
    do name += '_';
    while (!taken.insert(name).second);
  }
  return names;
}

}  // namespace sysid
