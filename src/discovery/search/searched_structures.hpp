// What a search found, as structures of the discovery.
#pragma once
#include <deque>
#include <vector>

#include "discovery/search/fit_conditions.hpp"
#include "discovery/simulation_validation.hpp"

namespace sysid {

struct StructureSearch {
  bool searched = false;                     // false: nothing else is set, and the regression's list stands
  std::deque<regression::Support> supports;  // of structures that the regression does not list
  std::vector<FoundStructure> structures;    // best first, the regression's choice among them
  SearchedRecord record;
};

/// A set of terms that was fitted, or weighed by the linearised motion.
struct SearchedTerms {
  Terms terms;
  Eigen::VectorXd coefficients;
  double score = 0;            // log evidence and prior
  Eigen::MatrixXd covariance;  // empty: not fitted
};

/// The `most` best of all, and the regression's choice if it is not one of them. listed: as the regression has them.
StructureSearch searched_structures(FoundSource const& source, WholeDictionary const& dictionary, std::vector<SearchedTerms> all,
                                    std::vector<FoundStructure> const& listed, int most);

/// Conditions and growth with the dictionary's channels in place of the model's.
void describe_record(WholeDictionary const& dictionary, FitConditions const& conditions, RecordLimits const& limits,
                     std::size_t channels, SearchedRecord& record);

}  // namespace sysid
