// Structures searched by the simulated motion.
#pragma once
#include <functional>
#include <vector>

#include "discovery/search/searched_structures.hpp"

namespace sysid {

/// From the regression's structures: fits by multiple shooting, linearised in all coefficients of the dictionary; what the
/// linearisation finds better is fitted, until nothing is. First over short segments, then over those that the best one follows.
/// listed: as best_structures gives them, at least one. Not searched where the dictionary as a whole is no explicit model, or where
/// no structure that is listed stays finite.
StructureSearch search_structures(FoundSource const& source, std::vector<FoundStructure> const& listed, int most,
                                  std::function<bool()> const& interrupted);

}  // namespace sysid
