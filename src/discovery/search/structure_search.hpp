// Structures searched by the simulated motion: the whole dictionary compiled once, each coefficient a parameter that is 0 where its
// term is out.
#pragma once
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "discovery/found_source.hpp"
#include "discovery/simulation_validation.hpp"

namespace sysid {

struct StructureSearch {
  bool searched = false;                     // false: nothing else is set, and the regression's list stands
  std::deque<regression::Support> supports;  // of structures that the regression does not list
  std::vector<FoundStructure> structures;    // best first, the regression's choice among them
  SearchedRecord record;
};

/// From the regression's structures: fits by multiple shooting, linearised in all coefficients of the dictionary; what the
/// linearisation finds better is fitted, until nothing is. First over short segments, then over those that the best one follows.
/// listed: as best_structures gives them, at least one. Not searched where the dictionary as a whole is no explicit model, or where
/// no structure that is listed stays finite.
StructureSearch search_structures(FoundSource const& source, std::vector<FoundStructure> const& listed, int most,
                                  std::function<bool()> const& interrupted);

}  // namespace sysid
