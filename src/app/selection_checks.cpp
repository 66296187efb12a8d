// Evidences, noise and integration against what the particles say.
#include "app/selection_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/fit_target.hpp"
#include "app/likelihood_check.hpp"
#include "core/elementary.hpp"
#include "likelihood/trajectory.hpp"
#include "report/number.hpp"

namespace sysid {
namespace {

/// A threshold further above the noise floor than this leaves more than the noise does.
constexpr double far_above_floor = 1.15;

/// A finer solver may move the median distance by this part of the threshold.
constexpr double tolerable_shift = 0.05;

}  // namespace

Findings add_likelihoods(std::vector<std::vector<Mode>> const& modes, SelectionReport& selection) {
  std::vector<double> logs, probabilities;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < modes.size(); ++k) {
    logs.push_back(log_evidence(modes[k]));
    highest = std::max(highest, logs[k] + elementary::log(selection.result.models[k].prior));
  }
  if (!std::isfinite(highest)) return {};
  double total = 0;
  for (std::size_t k = 0; k < logs.size(); ++k) {
    probabilities.push_back(elementary::exp(logs[k] + elementary::log(selection.result.models[k].prior) - highest));
    total += probabilities.back();
  }
  for (std::size_t k = 0; k < logs.size(); ++k) {
    probabilities[k] /= total;
    selection.likelihoods[k] = LikelihoodCheck{logs[k], probabilities[k]};
  }
  return compare_probabilities(selection.result, probabilities);
}

Findings add_noise_floor(Session const& session, Candidate const& leading, Distance const& distance, std::vector<Mode> const& modes,
                         SelectionReport& selection) {
  Model const& model = leading.compiled->model;
  bool const stated = leading.space->dimension() == leading.simulated->dimension();
  LaneArray declared(leading.space->dimension(), 1);
  if (stated) {
    SelectedModel const& best = selection.result.models[static_cast<std::size_t>(selection.leader())];
    for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = best.summaries[static_cast<std::size_t>(d)].mean;
  } else {
    if (modes.empty()) return {};
    for (int d = 0; d < declared.rows(); ++d) declared(d, 0) = modes.front().declared[static_cast<std::size_t>(d)];
  }
  std::vector<double> variance(model.channels.size());
  std::string words;
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    if (leading.measure.weights[c] == 0) continue;
    if (model.channels[c].noise.row->name != "normal") return {};
    double sum = 0, count = 0;
    for (std::size_t e = 0; e < leading.data.size(); ++e) {
      Experiment const& experiment = leading.data[e].experiment;
      LaneArray parameters(static_cast<int>(model.parameters.size()), 1);
      leading.space->select(leading.space->values_of_declared(declared), static_cast<int>(e), parameters);
      Trajectory const trajectory(leading.compiled, experiment, leading.fit->solver, start_rows(leading.fit->start),
                                  session.options.execution);
      auto const arguments = trajectory.noise_arguments(parameters, static_cast<int>(c));
      for (std::size_t i = 0; i < arguments.size(); ++i)
        if (experiment.scored[i] != 0 && !experiment.measured[c].empty() && std::isfinite(experiment.measured[c][i]))
          sum += arguments[i][1] * arguments[i][1], count += 1;
    }
    variance[c] = count > 0 ? sum / count : 0;
    words +=
        fmt::format("{}sd {}{} in {}", words.empty() ? "" : ", ", significant(model.channels[c].from_si(std::sqrt(variance[c])), 3),
                    model.channels[c].unit ? " [" + model.channels[c].unit_text() + "]" : "", model.channels[c].name);
  }
  std::vector<double> sd;
  for (double const v : variance) sd.push_back(std::sqrt(v));
  double const floor = distance.floor(sd);
  if (!std::isfinite(floor)) return {};
  selection.floor = floor;
  selection.floor_words = fmt::format("{} noise, {}", stated ? "the stated" : "the fitted", words);
  if (selection.result.threshold <= far_above_floor * floor) return {};
  return {{Severity::warning, "threshold_above_noise",
           fmt::format("the final threshold {} is {:.1f} times what {} leaves of the distance, {}",
                       significant(selection.result.threshold, 4), selection.result.threshold / floor, selection.floor_words,
                       significant(floor, 4)),
           "models that differ by less than that are not told apart: stop at a smaller change of the threshold, or "
           "none of the models is the right one"}};
}

Findings check_distances(SelectionTarget const& finer, int model, SelectionResult const& result, SolverSettings const& solver) {
  SelectedModel const& selected = result.models[static_cast<std::size_t>(model)];
  int const count = std::min<int>(100, static_cast<int>(selected.distance.size()));
  std::vector<double> distance(static_cast<std::size_t>(count)), shift;
  std::vector<Simulated> ending(static_cast<std::size_t>(count));
  SelectionTarget::Batch const batch{model, selected.theta.view().columns(0, count), distance, ending};
  finer.distances({&batch, 1}, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < distance.size(); ++i) shift.push_back(std::abs(distance[i] - selected.distance[i]));
  std::nth_element(shift.begin(), shift.begin() + count / 2, shift.end());
  double const median = shift[static_cast<std::size_t>(count / 2)];
  if (median <= tolerable_shift * result.threshold) return {};
  return {{Severity::warning, "step_not_settled",
           fmt::format("with {} distances move by {:.2g} of the threshold: part of them is the integrator's", solver.finer_words(),
                       median / result.threshold),
           "take a finer solver, `substeps = 4` or `solver = dopri5`"}};
}

}  // namespace sysid
