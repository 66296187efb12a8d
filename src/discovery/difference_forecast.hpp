// How well found difference equations predict rows that their choice did not use: one sample ahead, and in a free run.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "discovery/free_motion.hpp"
#include "regression/discovery.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Root mean squares over all rows of all experiments, SI, of one equation's target.
struct DifferenceErrors {
  double sd = 0;                   // of what is measured
  std::optional<double> one_step;  // nothing where no row has all samples before it
  std::optional<double> free_run;  // nothing where no run can begin; infinite where one does not stay finite
  int diverging = 0;               // of 50 runs that are drawn so
  double own_noise = 0;            // of the equation, on the rows of the task
  std::optional<double> expected;  // of the free run, if the equations are right: by their errors and those of the coefficients
};

struct DifferenceForecasts {
  std::vector<DifferenceErrors> errors;  // of each equation
  std::vector<FreeMotion> runs;          // of each experiment in which one can begin, with the channels of the dictionary
};

/// A free run begins behind 50 rows, or a quarter of them, which tell the errors of samples before, and goes on by its own samples
/// to the end of the experiment; inputs must be there. What to expect of it is the difference between runs whose errors
/// and coefficients are drawn as the equations have them and the run without. discovery: of the dictionary, all equations found.
/// experiments: with the dictionary's columns.
DifferenceForecasts difference_forecasts(regression::Dictionary const& dictionary, regression::Discovery const& discovery,
                                         std::span<Experiment const> experiments, std::uint64_t seed);

/// held_out: what the rows are called.
Findings forecast_findings(CheckedDictionary const& dictionary, std::vector<DifferenceErrors> const& errors,
                           std::string const& held_out);

}  // namespace sysid
