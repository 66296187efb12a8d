// Trajectories of posterior draws condensed to bands, and the scores of predictions.
#pragma once
#include <cstdint>
#include <vector>

#include "core/numeric/usable_trajectories.hpp"
#include "result/prediction.hpp"
#include "result/report.hpp"

namespace sysid {

/// trajectories[d][i]: draw d at sample i; a draw that failed (a value that is not finite where another draw's is) is left out, and
/// counted. NaN at samples where no draw is finite; empty when no draw is left.
Band band(std::vector<std::vector<double>> const& trajectories);

/// Of a measured quantity over the scored samples that are there; empty when there are none:
///   nmse         100/(n s^2) sum (y_i - mean_i)^2, s^2 the population variance of the measured y      Worden et al., eq. 8.18
///   rmse         sqrt(1/n sum (y_i - mean_i)^2), in the quantity's unit
///   coverage_95  share of y_i inside [q2.5, q97.5] with noise          (only when there is a band with noise)
///   coverage_3sd share of y_i within three sd with noise of the mean   (the same)
std::vector<Score> scores(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored);

/// One line per channel and experiment: the task's own scores, then those of the predicted bands that it has not taken itself.
std::vector<FitLine> fit_lines(Report const& report);

}  // namespace sysid
