// Parameters inside terms: where in their priors the record is explained best.
#pragma once
#include <span>
#include <vector>

#include "check/checked/checked.hpp"
#include "data/experiment.hpp"
#include "regression/discovery.hpp"

namespace sysid {

struct InnerSearch {
  struct Mode {
    std::vector<double> values;  // [inner], coherent SI
    double log_evidence = 0;
  };
  std::vector<Mode> modes;  // best first; at least one unless interrupted
  int evaluations = 0;      // regressions
  bool interrupted = false;
};

/// Local maxima of the sum over equations of the log evidence of the best support, at most `most`, none that is behind the first by
/// more than 20: first on points spread over the priors, then by steps along each parameter that are halved, both in the
/// probability of the prior below a value. The steps end where they no longer change the evidence, at the latest at 1/512, and
/// where nothing refines the values afterwards (`final_values`), at 2^-20, those of the best at 2^-44: a record with little noise
/// determines a value to less than 1/512 of its prior, an exact one to its last digits.
InnerSearch search_inner(CheckedDictionary const& dictionary, std::span<Experiment const> experiments,
                         regression::Method const& method, int most, bool final_values);

}  // namespace sysid
