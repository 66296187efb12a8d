// The figures of a report, as scripts; report/gnuplot draws them.
#pragma once
#include <vector>

#include "report/plot.hpp"
#include "report/report.hpp"

namespace sysid {

/// All that the report's data can fill, in the order in which the page shows them.
std::vector<plot::Figure> figures(Report const& report);

// One each; `figures` calls them.

/// Mean, bands and data of a quantity along the record, with its residuals below when it was measured.
plot::Figure fit_figure(Prediction const& prediction, PredictedQuantity const& quantity);
/// Autocorrelation of the residuals of a measured quantity.
plot::Figure residual_figure(Prediction const& prediction, PredictedQuantity const& quantity);
/// Marginal posteriors as histograms, the prior dashed.
plot::Figure posterior_figure(Report const& report);
/// Draws of each chain in order.
plot::Figure trace_figure(Draws const& draws);
/// How the ranks of each chain's draws spread over those of all (Vehtari et al. 2021).
plot::Figure rank_figure(Draws const& draws);
/// Model probabilities and thresholds over the populations of a selection.
plot::Figure population_figure(SelectionReport const& selection);
/// Draws of each two parameters against each other.
plot::Figure pair_figure(Draws const& draws);

/// Autocorrelation of a series at lags 0 ... lags, its mean removed; samples that are not finite are left out of every product.
std::vector<double> autocorrelation(std::vector<double> const& series, int lags);

}  // namespace sysid
