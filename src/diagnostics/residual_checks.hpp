// What a fit leaves unexplained, experiment by experiment and channel by channel: how much of it there is, of which size, and
// whether it is noise.
#pragma once
#include <string>
#include <vector>

#include "diagnostics/residual_offset.hpp"
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

/// Where a fit explains little: adds to the help which parameters have kept the width of their prior, which may hold others where
/// they cannot fit.
void name_held(Report const& report, Findings& findings);

/// `worse_than_the_mean` of a channel, with what to do.
Finding worse_than_the_mean(Severity severity, std::vector<std::string> names, std::string const& channel, double nmse,
                            std::string help);

/// nmse [%] from which a model is none of its record, whatever its residuals: the error is larger than what there was to explain.
inline constexpr double useless_nmse = 200;

/// The nmse [%] that a prediction exceeds by chance once in a thousand records where the mean explains all there is: of n samples
/// of noise about the right prediction the sums of squares about it and about the mean differ by less than sigma^2 chi-squared(2),
/// of 99.9 % quantile 13.8. A channel that did not change has no nmse, which exceeds nothing.
double as_bad_as_the_mean(std::size_t samples);

}  // namespace sysid
