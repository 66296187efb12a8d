// Experiments one by one: the mode of each alone.
#include "app/fit/experiment_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/residuals/residual_line.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_experiments = 12;  // each takes a local search of its own
constexpr double far_apart = 6;               // sds: by chance alone it does not happen
constexpr double least_gain = 20;             // nats, beyond what parameters of their own would gain by chance

/// Findings by which experiments, or disturbances in their place, may differ.
bool may_disagree(FinishedFit const& fit) {
  return fit.likelihood.model().filtered() || std::ranges::any_of(fit.report.findings, [](Finding const& each) {
           return each.code == FindingCode::residuals_not_white || each.code == FindingCode::input_in_residuals ||
                  each.code == FindingCode::residual_offset || each.code == FindingCode::residual_trend ||
                  each.code == FindingCode::noise_size || each.code == FindingCode::explains_little ||
                  each.code == FindingCode::worse_than_the_mean;
         });
}

/// Coordinates that all experiments read and that the response depends on: sizes of noises and disturbances are not the cause.
std::vector<std::size_t> shared_coordinates(ParameterSpace const& space) {
  std::vector<std::size_t> shared;
  for (std::size_t c = 0; c < space.sampled().size(); ++c)
    if (space.rows()[static_cast<std::size_t>(space.sampled()[c])].experiment < 0 && !space.infos()[c].size_alone)
      shared.push_back(c);
  return shared;
}

/// How many of these residuals one independent sample is: 1 at least. Where they are not white, sds of estimates are too small by
/// the root of it.
double samples_of_one(std::span<double const> residuals) {
  double const variance = residuals.size() > 1 ? sample_variance(residuals) : 0;
  return variance > 0 ? std::max(1.0, squared_standard_error(residuals) * static_cast<double>(residuals.size()) / variance) : 1;
}

/// The fit of one experiment by itself.
struct Alone {
  Mode mode;
  double gain = 0;      // of its log likelihood over that at the mode of the whole fit, counted in independent samples
  double widening = 1;  // of the sds, for the same reason
  bool found = false;
};

double sd_of(Alone const& alone, std::size_t coordinate) {
  std::size_t const n = alone.mode.theta.size();
  return alone.widening * std::sqrt(alone.mode.covariance[coordinate * n + coordinate]);
}

/// All experiments but one are not scored, so that parameters keep their places and their priors.
Alone fitted_alone(FinishedFit& fit, std::vector<Experiment> experiments, std::size_t which) {
  for (std::size_t k = 0; k < experiments.size(); ++k)
    if (k != which) experiments[k].scored.assign(experiments[k].scored.size(), 0);
  auto const target = fit.likelihood.make_target(std::move(experiments), fit.preparation.solver, fit.session.interruptible());
  Mode const& together = fit.preparation.modes.front();
  auto const stop = [&] { return fit.session.interrupted(); };
  Alone alone{refit(*target, fit.objective_kind, {together}, fit.seed, fit.extra, stop).front()};
  if (stop() || !std::isfinite(alone.mode.log_density)) return alone;
  std::vector<double> value(2);
  LaneArray const both = to_lanes({theta_of(together), theta_of(alone.mode)});
  target->log_likelihood(both, value, fit.extra);
  LaneArray residuals(target->residual_count(), 1);
  target->residuals(to_lanes({theta_of(alone.mode)}), residuals, fit.extra);
  std::vector<double> series(static_cast<std::size_t>(residuals.rows()));
  for (int r = 0; r < residuals.rows(); ++r) series[static_cast<std::size_t>(r)] = residuals(r, 0);
  double const worth = samples_of_one(series);
  alone.gain = (value[1] - value[0]) / worth;
  alone.widening = std::sqrt(worth);
  alone.found = std::isfinite(alone.gain);
  return alone;
}

/// Two experiments and the estimates of one parameter from them.
struct Apart {
  std::size_t coordinate = 0, one = 0, other = 0;
  double sds = 0;
};

/// For one parameter the two experiments that are farthest apart, on the unbounded scale.
Apart farthest(std::vector<Alone> const& alone, std::size_t coordinate) {
  Apart most{.coordinate = coordinate};
  for (std::size_t a = 0; a < alone.size(); ++a)
    for (std::size_t b = a + 1; b < alone.size(); ++b) {
      double const width = hypotenuse(sd_of(alone[a], coordinate), sd_of(alone[b], coordinate));
      double const sds = std::fabs(alone[a].mode.theta[coordinate] - alone[b].mode.theta[coordinate]) / width;
      if (std::isfinite(sds) && sds > most.sds) most = {coordinate, a, b, sds};
    }
  return most;
}

std::string value_text(Alone const& alone, std::size_t coordinate, std::string const& unit) {
  return fmt::format("{} ± {}{}", significant(alone.mode.declared[coordinate], 5),
                     significant(alone.widening * alone.mode.sd[coordinate], 2), unit_after_number(unit));
}

}  // namespace

std::string without_shared_parameters(FinishedFit const& fit) {
  if (fit.data.size() < 2) return "there is one experiment";
  if (fit.data.size() > most_experiments) return fmt::format("there are more than {} experiments", most_experiments);
  if (!fit.likelihood.space().members().empty()) return "the experiments have a population";
  if (shared_coordinates(fit.likelihood.space()).empty()) return "no parameter is shared by the experiments";
  if (fit.objective_kind == ObjectiveKind::likelihood) return "the likelihood of one experiment need not have a maximum";
  if (!fit.likelihood.model().processes.empty()) return "the model has a Gaussian process";
  if (fit.preparation.modes.empty()) return "the search found no mode";
  if (fit.target.is_expensive() || fit.target.is_estimated()) return "the likelihood is expensive or estimated";
  return may_disagree(fit) ? "" : "the residuals do not suggest it";
}

Findings check_shared_parameters(FinishedFit& fit) {
  ParameterSpace const& space = fit.likelihood.space();
  std::vector<Experiment> const experiments = experiments_of(fit.data);
  std::vector<Alone> alone;
  double gain = 0;
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    alone.push_back(fitted_alone(fit, experiments, e));
    if (!alone.back().found) return {};
    gain += alone.back().gain;
  }
  std::vector<std::size_t> const shared = shared_coordinates(space);
  if (gain < least_gain + static_cast<double>(shared.size() * (experiments.size() - 1))) return {};
  std::vector<Apart> apart;
  for (std::size_t const c : shared)
    if (Apart const most = farthest(alone, c); most.sds > far_apart) apart.push_back(most);
  if (apart.empty()) return {};
  std::ranges::stable_sort(apart, [](Apart const& a, Apart const& b) { return a.sds > b.sds; });
  Apart const& most = apart.front();
  ParameterInfo const& info = space.infos()[most.coordinate];
  std::string const one = experiments[most.one].name, other = experiments[most.other].name;
  std::vector<std::string> names = {info.name, one, other}, more;
  for (std::size_t k = 1; k < apart.size(); ++k) more.push_back(space.infos()[apart[k].coordinate].name);
  names.insert(names.end(), more.begin(), more.end());
  return {{FindingCode::experiments_disagree, Severity::warning, std::move(names),
           fmt::format("the experiments disagree about `{}`: {} from {} alone, {} from {} alone{}", info.name,
                       value_text(alone[most.one], most.coordinate, info.unit), one,
                       value_text(alone[most.other], most.coordinate, info.unit), other,
                       more.empty() ? "" : fmt::format("; also about {}", quoted(more))),
           fmt::format(
               "check what differs between {} and {}: units, the clock, the amplitude of the motion, the set-up; if `{}` itself "
               "may differ, declare it `per experiment`",
               one, other, info.name)}};
}

}  // namespace sysid
