// Draws to parameters of each experiment, and along its record.
#include "app/session/posterior_trajectories.hpp"

#include <algorithm>

#include "app/session/exact_steps.hpp"
#include "app/session/stored_draws.hpp"
#include "diagnostics/bands.hpp"

namespace sysid {

namespace {

/// Where the fit states none: it has looked for a number that suits the likelihood of a whole record, which bands do not need.
constexpr int particles_of_prediction = 1000;

/// The quantiles of 2.5 and 97.5 % lie between draws from 39 on.
constexpr int few_trajectories = 39, fewest_noises = 200;

/// The fit, with the errors that inputs have in the records that it predicts.
FitTask fit_of(Session const& session, PredictTask const& what) {
  FitTask fit = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what);
  fit.input_errors = what.input_errors;
  return fit;
}

}  // namespace

std::vector<std::uint8_t> corrected_rows(Experiment const& experiment, PredictionRule rule) {
  std::vector<std::uint8_t> rows(experiment.time.size(), 1);
  auto const first = std::ranges::find(experiment.scored, std::uint8_t{1}) - experiment.scored.begin();
  if (rule != PredictionRule::one_step) std::fill(rows.begin() + first, rows.end(), std::uint8_t{0});
  return rows;
}

PosteriorTrajectories::PosteriorTrajectories(Session& session, PredictTask const& what, std::uint64_t seed)
    : session_(session),
      what_(what),
      fitted_(fitted_model(session, what.fit)),
      fit_(fit_of(session, what)),
      solver_(solver_along(session, fit_, fitted_.solver, what.experiments, what)),
      free_start_(what.start.kind == StartRule::Kind::estimated),
      compiled_(session.compiled(fit_, free_start_, solver_.method, what.prediction)),
      space_(parameter_space(compiled_->model, fit_.experiments)),
      data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(fit_.model)], what.start,
                             rule_of_lags(fit_, session.file.models[static_cast<std::size_t>(fit_.model)], what.prediction),
                             solver_)),
      seed_(seed),
      wanted_(std::min<int>(what.draws, static_cast<int>(fitted_.draws.total()))) {
  if (model().filtered())
    for (ExperimentData& each : data_) each.experiment.corrects = corrected_rows(each.experiment, what.prediction);
}

std::vector<std::string> PosteriorTrajectories::drawn_from_prior(int e) const {
  std::vector<std::string> names;
  if (what_.fitted[static_cast<std::size_t>(e)] >= 0) return names;
  ExperimentUse const& use = data_[static_cast<std::size_t>(e)].use;
  for (std::size_t p = 0; p < model().parameters.size(); ++p)
    if (model().parameters[p].per_experiment && model().parameters[p].prior && !use.constants[p])
      names.push_back("`" + model().parameters[p].name + "`");
  return names;
}

std::vector<RunsAlong> PosteriorTrajectories::fitted_runs() const {
  std::vector<RunsAlong> runs;
  try {
    std::vector<ExperimentData> const data = load_experiments(
        session_, fit_.experiments, session_.file.models[static_cast<std::size_t>(fit_.model)], fit_.start, fit_.prediction);
    LaneArray const declared = spread(fitted_.draws, wanted_);
    for (std::size_t e = 0; e < data.size(); ++e) {
      LaneArray own(static_cast<int>(model().parameters.size()), declared.width());
      space_->select(space_->values_of_declared(declared), static_cast<int>(e), own);
      runs.push_back({data[e].experiment, fit_.start.kind == StartRule::Kind::estimated ? fit_.start.rows : 0, std::move(own)});
    }
  } catch (IoError const&) {  // stored draws outlive their data
    return {};
  } catch (UserError const&) {
    return {};
  }
  return runs;
}

LaneArray PosteriorTrajectories::parameters(int e) const {
  LaneArray const declared = spread(fitted_.draws, what_.redraw_each_step ? static_cast<int>(fitted_.draws.total()) : wanted_);
  int const fitted = what_.fitted[static_cast<std::size_t>(e)];
  if (fitted >= 0) {
    LaneArray own(static_cast<int>(model().parameters.size()), declared.width());
    space_->select(space_->values_of_declared(declared), fitted, own);
    return own;
  }
  return space_->of_new_experiment(declared, data_[static_cast<std::size_t>(e)].use.constants,
                                   {seed_, Purpose::population, static_cast<std::uint64_t>(e) << 32, 0});
}

Trajectory PosteriorTrajectories::trajectory(int e) const {
  return {compiled_,
          data_[static_cast<std::size_t>(e)].experiment,
          solver_,
          start_rows(),
          session_.abandonable(),
          [this](NodeId node, Graph const& graph) { return session_.describe(fit_.model, graph, node); }};
}

Trajectory::Result PosteriorTrajectories::run(int e, Trajectory const& trajectory, ConstLanes parameters, bool moments) const {
  if (fit_.filter == FilterRule::particle) return by_particles(e, parameters);
  StreamKey const noise = prediction_noise(seed_, e);
  return what_.redraw_each_step ? trajectory.run_redrawn(parameters, wanted_, {seed_, Purpose::redraw, noise.index, 0}, noise)
                                : trajectory.run(parameters, noise, moments, what_.ahead);
}

void PosteriorTrajectories::add_noise(int e, Trajectory const& trajectory, ConstLanes parameters,
                                      Trajectory::Result& result) const {
  int const draws = parameters.width(), times = (std::max(fewest_noises, what_.draws) + draws - 1) / draws;
  if (model().channels.empty() || draws >= few_trajectories || (what_.redraw_each_step && draws > 1)) return;
  if (fit_.filter != FilterRule::particle) {
    result.noisy = trajectory.run(parameters, prediction_noise(seed_, e), false, what_.ahead, times).noisy;
    return;
  }
  LaneArray all(parameters.rows(), draws * times);
  for (int r = 0; r < all.rows(); ++r)
    for (int w = 0; w < all.width(); ++w) all(r, w) = parameters(r, w % draws);
  result.noisy = by_particles(e, all).noisy;
}

Trajectory::Result PosteriorTrajectories::by_particles(int e, ConstLanes parameters) const {
  ParticleTrajectory const particles(particle_model(model(), fitted_.solver.method), model(),
                                     data_[static_cast<std::size_t>(e)].experiment, fitted_.solver,
                                     fit_.particles > 0 ? fit_.particles : particles_of_prediction, session_.abandonable());
  return particles
      .run(parameters, {seed_, Purpose::particle, static_cast<std::uint64_t>(e) << 32, 0}, false, std::max(1, what_.ahead))
      .predicted;
}

PointwiseLikelihood PosteriorTrajectories::pointwise(int e) const {
  return {compiled_, data_[static_cast<std::size_t>(e)].experiment, solver_, start_rows(), session_.abandonable()};
}

}  // namespace sysid
