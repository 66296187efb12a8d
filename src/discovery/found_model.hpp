// One structure of a discovery as the text of a model: declarations, priors, equations, observations.
#pragma once
#include <cstddef>
#include <set>
#include <string>

#include "discovery/found_structure.hpp"

namespace sysid {

struct FoundSource;  // discovery/found_source.hpp

struct FoundModel {
  std::string text;
  std::set<std::size_t> inputs;  // of the dictionary, that it reads
};

FoundModel found_model(FoundSource const& source, FoundStructure const& structure, std::string const& name,
                       std::string const& title);

}  // namespace sysid
