// Structures without the terms that a fit by simulation has left idle.
#pragma once
#include <deque>
#include <vector>

#include "discovery/simulation_validation.hpp"

namespace sysid {

/// Of the first structures that were validated: each without one term whose coefficient is less than three sds from zero, and
/// without all of these. A search at values of parameters inside terms that are a little wrong keeps terms that make up for it;
/// with the parameters free they may go. supports: where theirs are kept, which have to stay as long as the structures.
std::vector<FoundStructure> without_idle_terms(CheckedDictionary const& dictionary, Validation const& validation,
                                               std::deque<regression::Support>& supports);

}  // namespace sysid
