// How well a model with Gaussian processes predicts samples that it was fitted to, each from all the others.
#pragma once
#include <vector>

#include "experiment/experiments.hpp"
#include "likelihood/process/process_target.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

struct ProcessScores {
  std::vector<FitLine> lines;  // per channel: nmse_left_out, rmse_left_out, coverage_95_left_out
  Findings findings;
};

/// At one vector of all parameters, declared. Residuals of samples that are left out one by one have the sizes that the process
/// and the noise say; where they have not, it is said.
ProcessScores score_leave_one_out(ProcessTarget const& target, ParameterSpace const& all, std::vector<double> const& declared,
                                  std::vector<ExperimentData> const& data);

}  // namespace sysid
