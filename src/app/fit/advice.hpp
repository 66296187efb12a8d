// What the solver and the motion of a fit have to do with a result that failed: searches and back ends know of neither.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "diagnostics/tolerance/tolerance.hpp"
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

struct FitSituation {
  Model const& model;
  std::vector<ExperimentData> const& data;
  SolverSettings const& solver;
  Ledger const& ledger;                  // of the solves behind the finding
  SearchSolver const* search = nullptr;  // how the search's solver was chosen, where it was
  Finding const* scales = nullptr;       // `time_scales_apart`, where it was found
};

/// Adds to message and help of the finding what may stand behind it; of several reasons the surest has the last word.
void advise(FitSituation const& situation, Finding& finding);

}  // namespace sysid
