// Draws along the records once more.
#include "exchange/simulated_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "app/session/derived_draws.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/stored_draws.hpp"
#include "diagnostics/bands.hpp"
#include "exchange/draws_group.hpp"
#include "exchange/predictions_data.hpp"
#include "exchange/sample_groups.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/pointwise.hpp"

namespace sysid {
namespace {

/// Which draws of each chain stand for all: their numbers, the same in every chain.
std::vector<std::size_t> spread_over_chain(Draws const& draws, int wanted) {
  Draws numbered;
  numbered.parameter_count = 1;
  numbered.chains.emplace_back();
  for (std::size_t d = 0; d < draws.chains.front().values.size(); ++d)
    numbered.chains.front().values.push_back({static_cast<double>(d)});
  LaneArray const picked = spread(numbered, std::max(1, wanted / static_cast<int>(draws.chains.size())));
  std::vector<std::size_t> numbers;
  for (int w = 0; w < picked.width(); ++w) numbers.push_back(static_cast<std::size_t>(picked(0, w)));
  return numbers;
}

/// Chain by chain, those draws.
LaneArray columns_of(Draws const& draws, std::vector<std::size_t> const& numbers) {
  LaneArray columns(draws.parameter_count, static_cast<int>(draws.chains.size() * numbers.size()));
  int w = 0;
  for (Chain const& chain : draws.chains)
    for (std::size_t const d : numbers) {
      for (int p = 0; p < draws.parameter_count; ++p) columns(p, w) = chain.values[d][static_cast<std::size_t>(p)];
      ++w;
    }
  return columns;
}

void add_draw_dimensions(NetcdfGroup& group, std::size_t chains, std::vector<std::size_t> const& numbers) {
  std::vector<std::int64_t> chain, draw(numbers.begin(), numbers.end());
  for (std::size_t c = 0; c < chains; ++c) chain.push_back(static_cast<std::int64_t>(c));
  group.add_dimension({"chain", {}, std::move(chain), {}});
  group.add_dimension({"draw", {}, std::move(draw), {}});
}

/// What a fit task is made of, from its stored results.
struct StoredFit {
  StoredFit(Session& session, int index)
      : session(session),
        what(std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(index)].what)),
        fitted(fitted_model(session, index)),
        compiled(session.compiled(what, fitted.solver.method)),
        space(parameter_space(compiled->model, what.experiments)),
        data(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                              what.prediction, fitted.solver)) {}

  Session& session;
  FitTask const& what;
  FittedModel const& fitted;
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<ParameterSpace const> space;
  std::vector<ExperimentData> data;

  Model const& model() const { return compiled->model; }
  /// Of experiment e, where there are several.
  std::string label(std::size_t e) const { return data.size() > 1 ? data[e].experiment.name : std::string(); }
  /// Parameters of the model in experiment e, SI, of declared values.
  LaneArray parameters(std::size_t e, ConstLanes declared) const {
    LaneArray own(static_cast<int>(model().parameters.size()), declared.width());
    space->select(space->values_of_declared(declared), static_cast<int>(e), own);
    return own;
  }
};

/// The rows of channel c that have a density. A sample that is missing has none: such a channel has rows of its own.
RowsOfExperiment rows_with_density(StoredFit const& fit, std::size_t e, std::size_t c, std::vector<int> samples) {
  RowsOfExperiment rows = scored_rows(fit.data[e].experiment, fit.model().dynamics, fit.label(e));
  if (rows.rows == samples) return rows;
  std::string const& name = fit.model().channels[c].name;
  rows.dimension = labelled("row_" + name, fit.label(e));
  if (!rows.time.empty()) rows.time = labelled("time_" + name, fit.label(e));
  rows.rows = std::move(samples);
  return rows;
}

void add_log_likelihood(NetcdfGroup& group, StoredFit const& fit, std::size_t e, ConstLanes declared) {
  Experiment const& experiment = fit.data[e].experiment;
  PointwiseLikelihood const pointwise(fit.compiled, experiment, fit.fitted.solver, start_rows(fit.what.start),
                                      fit.session.options.execution);
  auto const values = pointwise.run(fit.parameters(e, declared));
  for (std::size_t c = 0; c < fit.model().channels.size(); ++c) {
    if (pointwise.samples(static_cast<int>(c)).empty()) continue;
    RowsOfExperiment const rows = rows_with_density(fit, e, c, pointwise.samples(static_cast<int>(c)));
    if (!group.has_dimension(rows.dimension)) add_rows(group, experiment, rows);
    std::vector<double> flat;
    for (auto const& draw : values[c]) flat.insert(flat.end(), draw.begin(), draw.end());
    group.add({labelled(fit.model().channels[c].name, fit.label(e)),
               {"chain", "draw", rows.dimension},
               std::move(flat),
               row_attributes("", rows)});
  }
}

/// Trajectories along all experiments of declared values, lane by lane over chains and draws, which the group's dimensions are.
/// learns: from the measured samples before a row, where states are random.
void add_predictive(NetcdfGroup& group, StoredFit const& fit, ConstLanes declared, std::uint64_t seed, bool learns) {
  for (std::size_t e = 0; e < fit.data.size(); ++e) {
    Experiment const& experiment = fit.data[e].experiment;
    RowsOfExperiment const rows = scored_rows(experiment, fit.model().dynamics, fit.label(e));
    add_rows(group, experiment, rows);
    Trajectory const trajectory(fit.compiled, learns ? experiment : experiment.unread(), fit.fitted.solver,
                                start_rows(fit.what.start), fit.session.options.execution);
    add_trajectories(group, fit.model(), trajectory.quantities(),
                     trajectory.run(fit.parameters(e, declared), prediction_noise(seed, static_cast<int>(e))), rows, fit.label(e));
  }
}

/// Draws of the prior, of one chain, with what derives from them.
Draws prior_draws(StoredFit const& fit, int wanted, std::uint64_t seed) {
  Draws draws;
  draws.parameter_count = fit.space->dimension();
  for (ParameterInfo const& parameter : fit.space->infos()) {
    draws.names.push_back(parameter.name);
    draws.units.push_back(parameter.unit);
  }
  LaneArray theta(fit.space->dimension(), wanted), declared(fit.space->dimension(), wanted);
  fit.space->sample_prior({seed, Purpose::prior, 0, 0}, theta);
  fit.space->constrain(theta, declared);
  draws.chains.emplace_back();
  for (int w = 0; w < wanted; ++w) {
    draws.chains.front().values.emplace_back();
    for (int p = 0; p < declared.rows(); ++p) draws.chains.front().values.back().push_back(declared(p, w));
  }
  add_derived(*fit.compiled, *fit.space, draws);
  return draws;
}

/// Whether these groups are left out.
bool by_particles(StoredFit const& fit, char const* groups, InferenceData& data) {
  if (fit.what.filter != FilterRule::particle) return false;
  data.omitted.push_back(fmt::format("{}: the fit estimates its likelihood by particles", groups));
  return true;
}

void add_posterior_groups(StoredFit const& fit, int draws, std::uint64_t seed, InferenceData& data) {
  if (by_particles(fit, "log_likelihood, posterior_predictive", data)) return;
  std::vector<std::size_t> const numbers = spread_over_chain(fit.fitted.draws, draws);
  LaneArray const declared = columns_of(fit.fitted.draws, numbers);
  NetcdfGroup likelihood("log_likelihood"), predictive("posterior_predictive");
  for (NetcdfGroup* group : {&likelihood, &predictive}) add_draw_dimensions(*group, fit.fitted.draws.chains.size(), numbers);
  for (std::size_t e = 0; e < fit.data.size(); ++e) add_log_likelihood(likelihood, fit, e, declared);
  add_predictive(predictive, fit, declared, seed, true);
  data.add(std::move(likelihood));
  data.add(std::move(predictive));
}

void add_prior_groups(StoredFit const& fit, int draws, std::uint64_t seed, InferenceData& data) {
  if (Parameter const* parameter = fit.model().improper()) {
    data.omitted.push_back(fmt::format("prior, prior_predictive: the prior of `{}` is {} and cannot be sampled", parameter->name,
                                       parameter->prior->row->name));
    return;
  }
  Draws const drawn = prior_draws(fit, draws, seed);
  NetcdfGroup prior("prior"), predictive("prior_predictive");
  add_draws(prior, drawn);
  if (by_particles(fit, "prior_predictive", data)) return data.add(std::move(prior));
  std::vector<std::size_t> all(drawn.total());
  std::iota(all.begin(), all.end(), std::size_t{0});
  add_draw_dimensions(predictive, 1, all);
  add_predictive(predictive, fit, columns_of(drawn, all), seed, false);
  data.add(std::move(prior));
  data.add(std::move(predictive));
}

}  // namespace

void add_simulated(Session& session, int index, StoredResult const& stored, int draws, InferenceData& data) {
  FitTask const& what = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(index)].what);
  fitted_model(session, index);  // refuses results of another text or other data before anything is added
  add_data(session, what, data);
  draws = std::min(draws, static_cast<int>(stored_draws(stored).total()));
  if (!session.file.models[static_cast<std::size_t>(what.model)].processes.empty()) {
    add_process_predictive(session, index, stored.seed(), draws, data);
    data.omitted.push_back(
        "log_likelihood, prior, prior_predictive: with a Gaussian process over the rows the samples have only a joint density, and "
        "draws from its prior are not supported");
    return;
  }
  StoredFit const fit(session, index);
  add_posterior_groups(fit, draws, stored.seed(), data);
  add_prior_groups(fit, draws, stored.seed(), data);
}

}  // namespace sysid
