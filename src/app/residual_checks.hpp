// What a fit leaves unexplained, experiment by experiment and channel by channel: how much of it there is, of which size, and
// whether it is noise.
#pragma once
#include <string>
#include <vector>

#include "inference/finding.hpp"
#include "likelihood/model_target.hpp"
#include "report/report.hpp"

namespace sysid {

/// " on bench.train", where there is more than one experiment to tell apart.
std::string on_experiment(ModelTarget const& target, int experiment);

struct FitCheck {
  std::vector<FitLine> lines;  // per experiment and channel: nmse, rmse, chi_squared_per_sample, whiteness_p, input_correlation_p
  Findings findings;
};

/// At one parameter vector (declared units): scores and residual tests per experiment and channel, against every input.
FitCheck check_residuals(ModelTarget const& target, std::vector<double> const& declared);

}  // namespace sysid
