// The figures of a report, as scripts; report/figure/gnuplot draws them. Each is a file figure_NAME.cpp beside this one and a
// function declared here; figures.cpp decides which reports have it, and in which order.
#pragma once
#include <string_view>
#include <vector>

#include "report/figure/plot.hpp"
#include "result/report.hpp"

namespace sysid {

/// All figures for which the report has data, in the order in which the page shows them.
std::vector<plot::Figure> figures(Report const& report);

// One function for each figure, called by `figures`. `where`, such as " on bench.train", distinguishes the figures of several
// experiments; it is empty if there is one.

/// Mean, bands and data of a quantity along the record, with its residuals below when it was measured; of smoothed states, too.
plot::Figure fit_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where = {});
/// The same of a free run of equations that a discovery found.
plot::Figure free_run_figure(Prediction const& run, PredictedQuantity const& quantity);
/// The most samples that a figure shows; more cannot be distinguished.
inline constexpr std::size_t shown_samples = 600;
/// Whether a measured quantity has more samples than `fit_figure` shows.
bool is_long(Prediction const& prediction, PredictedQuantity const& quantity);
/// The range of data, model and residuals in stretches of a long record.
plot::Figure whole_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where = {});
/// Whether a measured quantity has residuals, and so many that their correlations mean something.
bool has_residuals(Prediction const& prediction, PredictedQuantity const& quantity);
/// Autocorrelation of the residuals of a measured quantity, and their correlation with each input before them.
plot::Figure residual_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where = {});
/// Whether rows are independent and inputs vary, so that a measured quantity can be seen over them.
bool over_inputs(Prediction const& prediction, PredictedQuantity const& quantity);
/// Mean, bands and data of a measured quantity over each input: a curve where there is one input.
plot::Figure input_figure(Prediction const& prediction, PredictedQuantity const& quantity, std::string_view where = {});
/// Restoring force against displacement and against velocity: loops of a hysteresis, a curve of a spring.
plot::Figure loop_figure(RestoringForce const& force, std::string_view where = {});
/// Restoring force over displacement and velocity, with the points of the data. The surface is not empty.
plot::Figure surface_figure(RestoringForce const& force, std::string_view where = {});
/// Inclusion probabilities of the terms of an equation of a discovery.
plot::Figure inclusion_figure(DiscoveryReport const& discovery, std::size_t equation);
/// Whether any term that was chosen has a coefficient with a spread.
bool has_coefficients(DiscoveredEquation const& equation);
/// One panel for each cut: mean and 90 % band, and along the bottom how often the record reads the function there.
plot::Figure function_figure(FunctionReport const& function);
/// Posterior densities of the coefficients of the terms that were chosen.
plot::Figure coefficient_figure(DiscoveryReport const& discovery, std::size_t equation);
/// Marginal posteriors as histograms and densities, the prior dashed, the truth of made data as a line. particles: the draws are
/// those of a population of particles, not of the posterior.
plot::Figure posterior_figure(Report const& report, bool particles = false);
/// Draws of each chain in order.
plot::Figure trace_figure(Draws const& draws);
/// How the ranks of each chain's draws spread over those of all (Vehtari et al. 2021).
plot::Figure rank_figure(Draws const& draws);
/// Model probabilities and thresholds over the populations of a selection.
plot::Figure population_figure(SelectionReport const& selection);
/// Probabilities of models between which chains have jumped.
plot::Figure model_figure(SelectionReport const& selection);
/// Histogram of the ranks of the true values among posterior draws. There are replications with draws.
plot::Figure true_ranks_figure(CalibrationReport const& calibration);
/// The distribution of these ranks minus the uniform one, with its simultaneous band.
plot::Figure rank_difference_figure(CalibrationReport const& calibration);
/// Draws of each pair of parameters against each other.
plot::Figure pair_figure(Draws const& draws);

}  // namespace sysid
