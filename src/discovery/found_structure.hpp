// Structures of a discovery: one support for each equation, what becomes a model.
#pragma once
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "regression/discovery.hpp"

namespace sysid {

struct FoundStructure {
  std::vector<regression::Support const*> equations;
  double score = 0;  // log probability, or log evidence where the selector knows no probabilities; summed over equations
};

/// The structure that was chosen first, then the best of the others; each support as its equation lists it. Empty when an equation
/// was not found.
std::vector<FoundStructure> best_structures(regression::Discovery const& discovery, int most);

/// "y', y, y^3"; of several equations "prey': prey, prey*predator; predator': ...".
std::string structure_text(CheckedDictionary const& dictionary, FoundStructure const& structure);

}  // namespace sysid
