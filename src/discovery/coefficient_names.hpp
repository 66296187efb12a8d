// What the coefficients of a discovery are called.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"

namespace sysid {

/// All that the dictionary declares.
std::set<std::string> declared_names(CheckedDictionary const& dictionary);

/// Names of the coefficients of one equation's terms in the source: the parameter where one is named, else `a3`, the third term of
/// the first equation.
std::vector<std::string> coefficient_names(CheckedDictionary const& dictionary, int equation);

}  // namespace sysid
