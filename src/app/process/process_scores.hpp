// How well a model with Gaussian processes predicts samples that it was fitted to, each from all the others, and what its bands
// lack.
#pragma once
#include <vector>

#include "diagnostics/residuals/residual_checks.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/process/process_target.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

/// At one vector of all parameters, declared. Per channel nmse_left_out, rmse, coverage_95 and chi_squared_per_sample of samples
/// that are predicted from all others.
FitCheck score_leave_one_out(ProcessTarget const& target, ParameterSpace const& all, std::vector<double> const& declared,
                             std::vector<ExperimentData> const& data);

/// Channels without a value somewhere along some trajectories; their parametric parts, which follow them in the prediction, add
/// nothing to that. failed: trajectories that are reported already.
Findings channel_band_findings(Prediction prediction, Model const& model, int failed, bool several);

}  // namespace sysid
