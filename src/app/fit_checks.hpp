// What a finished fit is asked: does the model leave structure in the residuals, is the noise as stated, would another timing of
// the input fit much better, do draws pile up at bounds.
#pragma once
#include <string>
#include <vector>

#include "inference/backend.hpp"
#include "likelihood/model_target.hpp"
#include "report/prediction.hpp"

namespace sysid {

struct FitCheck {
  std::vector<Score> scores;  // over all channels, by name: nmse, rmse, chi_squared_per_sample, ...
  Findings findings;
};

/// At one parameter vector (declared units): scores and residual tests per channel, against every input.
FitCheck check_residuals(ModelTarget const& target, std::vector<double> const& declared);

/// A much better fit with the input half a sample earlier or later (more than `0.2` nats per scored sample, and 20 in all) means
/// that the rule between input samples is not the one of the experiment. mode: the best one.
Findings check_input_timing(ModelTarget const& target, Mode const& mode, std::uint64_t seed, Ledger& ledger);

}  // namespace sysid
