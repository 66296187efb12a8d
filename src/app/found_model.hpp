// One structure of a discovery as the text of a model: declarations, priors, equations, observations.
#pragma once
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "app/found_structure.hpp"
#include "check/checked.hpp"

namespace sysid {

struct FoundSource;  // app/found_source.hpp

struct FoundModel {
  std::string text;
  std::set<std::size_t> inputs;  // of the dictionary, that it reads
};

FoundModel found_model(FoundSource const& source, FoundStructure const& structure, std::string const& name,
                       std::string const& title);

/// Names of the coefficients of one equation's terms in the source: the parameter where one is named, else `a3`, the third term of
/// the first equation.
std::vector<std::string> coefficient_names(CheckedDictionary const& dictionary, int equation);

}  // namespace sysid
