// Which figures a report has, in reading order.
#include "report/figure/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/text/told_apart.hpp"

namespace sysid {

using namespace plot;

namespace {

/// A state that a channel shows as it is (observe y) needs no figure of its own.
bool repeats_a_channel(Prediction const& prediction, PredictedQuantity const& quantity) {
  if (!quantity.measured.empty()) return false;
  return std::any_of(prediction.quantities.begin(), prediction.quantities.end(), [&](PredictedQuantity const& other) {
    return !other.measured.empty() && other.unit == quantity.unit && other.response.mean == quantity.response.mean;
  });
}

/// How many records forces are known along.
std::size_t records_of(std::vector<RestoringForce> const& forces) {
  std::set<std::string> records;
  for (RestoringForce const& force : forces) records.insert(force.experiment);
  return records.size();
}

/// Coefficients of unknown functions have a figure of their function.
Draws without_coefficients(Report const& report) {
  Draws draws = report.draws;
  for (std::size_t c = std::min(report.summary.size(), draws.names.size()); c-- > 0;) {
    if (!report.summary[c].coefficient) continue;
    auto const at = static_cast<std::ptrdiff_t>(c);
    draws.names.erase(draws.names.begin() + at);
    draws.units.erase(draws.units.begin() + at);
    if (at < draws.parameter_count) --draws.parameter_count;
    for (Chain& chain : draws.chains)
      for (std::vector<double>& row : chain.values) row.erase(row.begin() + at);
  }
  return draws;
}

/// What nothing measures and what stays where it is has nothing to show.
bool shows_something(PredictedQuantity const& quantity) {
  std::vector<double> const& mean = quantity.response.mean;
  return !mean.empty() &&
         (!quantity.measured.empty() || std::any_of(mean.begin(), mean.end(), [&](double each) { return each != mean.front(); }));
}

std::vector<Figure> all_figures(Report const& report) {
  std::vector<Figure> out;
  bool const several = report.predictions.size() > 1;
  auto const where = [&](std::string const& experiment) { return several ? " on " + experiment : std::string(); };
  if (report.selection)
    out.push_back(report.selection->result.jumps ? model_figure(*report.selection) : population_figure(*report.selection));
  if (report.calibration && report.calibration->with_draws() > 0) {
    out.push_back(true_ranks_figure(*report.calibration));
    out.push_back(rank_difference_figure(*report.calibration));
  }
  if (report.discovery)
    for (Prediction const& run : report.discovery->free_runs)
      for (PredictedQuantity const& quantity : run.quantities)
        if (run.time.size() > 1) {
          out.push_back(free_run_figure(run, quantity));
          if (is_long(run, quantity)) out.push_back(whole_figure(run, quantity));
        }
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities)
      if (shows_something(quantity) && prediction.time.size() > 1 && !repeats_a_channel(prediction, quantity)) {
        out.push_back(fit_figure(prediction, quantity, where(prediction.experiment)));
        if (is_long(prediction, quantity)) out.push_back(whole_figure(prediction, quantity, where(prediction.experiment)));
        if (report.verb == "track")
          out.back().caption =
              fmt::format("The parameter {} along the rows that were tracked, with its 95 % band.{}", quantity.name,
                          quantity.alarms.empty() ? "" : " Vertical lines: rows at which a change was found.");
      }
  for (Prediction const& states : report.states)
    for (PredictedQuantity const& quantity : states.quantities)
      if (shows_something(quantity) && states.time.size() > 1)
        out.push_back(fit_figure(states, quantity, where(states.experiment)));
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities)
      if (over_inputs(prediction, quantity)) out.push_back(input_figure(prediction, quantity, where(prediction.experiment)));
  for (FunctionReport const& function : report.functions) out.push_back(function_figure(function));
  for (RestoringForce const& force : report.forces) {
    out.push_back(loop_figure(force, where(force.experiment)));
    if (!force.surface.empty()) out.push_back(surface_figure(force, where(force.experiment)));
  }
  if (std::size_t const records = records_of(report.forces); records > 0 && records < report.predictions.size())
    out.back().caption += fmt::format(" Restoring forces are shown along {} of {} records.", records, report.predictions.size());
  if (report.discovery)
    for (std::size_t e = 0; e < report.discovery->equations.size(); ++e) {
      if (!report.discovery->equations[e].terms.empty()) out.push_back(inclusion_figure(*report.discovery, e));
      if (has_coefficients(report.discovery->equations[e])) out.push_back(coefficient_figure(*report.discovery, e));
    }
  if (report.selection) {
    Report const leading = leading_model(report);
    bool const particles =
        !report.selection->result.jumps && !report.selection->has_chains(static_cast<std::size_t>(report.selection->leader()));
    auto const add = [&](Figure figure) {
      if (particles)
        figure.caption +=
            " These are the particles of the last population: how far they spread depends on the threshold, and is not the spread "
            "of "
            "the posterior.";
      out.push_back(std::move(figure));
    };
    if (leading.draws.total() > 1 && !leading.draws.names.empty()) add(posterior_figure(leading, particles));
    if (leading.draws.total() > 1 && leading.draws.names.size() > 1) add(pair_figure(leading.draws));
  }
  bool const has_draws = !report.draws.names.empty() && report.draws.total() > 1;
  if (has_draws && report.summary.size() == report.draws.names.size()) out.push_back(posterior_figure(report));
  if (has_draws)
    if (Draws const draws = without_coefficients(report); draws.names.size() > 1) out.push_back(pair_figure(draws));
  if (has_draws) out.push_back(trace_figure(report.draws));
  if (has_draws && report.draws.chains.size() > 1) out.push_back(rank_figure(report.draws));
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities)
      if (has_residuals(prediction, quantity)) out.push_back(residual_figure(prediction, quantity, where(prediction.experiment)));
  return out;
}

}  // namespace

std::vector<Figure> figures(Report const& report) {
  std::vector<Figure> out = all_figures(report);
  std::vector<std::string> names;
  for (Figure const& each : out) names.push_back(each.name);
  // Channels in Greek letters, or experiments that differ in a dot, would share their files.
  names = told_apart(std::move(names));
  for (std::size_t i = 0; i < out.size(); ++i)
    if (out[i].name != names[i]) plot::rename(out[i], names[i]);
  return out;
}

}  // namespace sysid
