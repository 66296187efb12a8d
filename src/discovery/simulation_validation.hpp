// Discovered structures validated by the motion itself: refitted by simulation, ranked by evidence, checked for stability, scored
// on held-out rows.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "discovery/found_source.hpp"
#include "likelihood/segments/segments.hpp"
#include "result/finding.hpp"
#include "result/prediction.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// What a search of structures knows of the record.
struct SearchedRecord {
  NoiseShape noise = {};            // with the dictionary's channels
  std::vector<double> growth = {};  // per channel, SI: ValidatedChannel::growth; empty: 0
  int substeps = 1;
  double others = 0;  // weight of all structures that are not validated, that of the best taken as 1
  std::optional<OutsideEquation> outside = {};
};

struct Validation {
  ValidationReport report;
  std::vector<FoundStructure> order;  // best first, parallel to report.structures; parameters inside terms as fitted
  Findings findings;
  std::vector<Prediction> free_runs;  // of the first, along the rows that are scored; empty where none are, or it is not validated
  bool interrupted = false;           // nothing else is set
};

/// structures: as best_structures gives them, the regression's choice first; at least one. unused: experiments that the task did
/// not use, with the dictionary's columns; where there are none the last fifth of each of the task's is held out for the scores.
/// Every structure is fitted over the same segments: as long as the best one follows the record. The same bytes for any number of
/// threads and lanes.
Validation validate_structures(FoundSource const& source, std::vector<FoundStructure> structures,
                               std::vector<ExperimentData> const& unused, SearchedRecord const& searched,
                               std::function<bool()> const& interrupted);

}  // namespace sysid
