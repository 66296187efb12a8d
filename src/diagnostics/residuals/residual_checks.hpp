// What a fit leaves unexplained, experiment by experiment and channel by channel: how much of it there is, of which size, and
// whether it is noise.
#pragma once
#include <string>
#include <vector>

#include "diagnostics/residuals/residual_line.hpp"
#include "likelihood/model_target.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

struct FitCheck {
  std::vector<FitLine> lines;  // per experiment and channel: nmse, rmse, chi_squared_per_sample, whiteness_p, input_correlation_p
  Findings findings;
};

/// Residuals of unit size and what was predicted [channels][samples], where states are random and no trajectory tells them; NaN
/// where not scored.
struct StandardisedRows {
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> predicted;  // declared units
};
/// Per experiment.
FitCheck check_residuals(Model const& model, std::vector<Experiment> const& experiments, std::vector<StandardisedRows> const& rows);

/// At one parameter vector (declared units): scores and residual tests per experiment and channel, against every input. text:
/// for the cures.
FitCheck check_residuals(ModelTarget const& target, std::vector<double> const& declared, UserText const& text = {});

}  // namespace sysid
