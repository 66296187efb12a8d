// Draws to functions along each experiment's record.
#include "app/process/process_trajectories.hpp"

#include <algorithm>

#include "app/process/process_draws.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/stored_draws.hpp"
#include "diagnostics/bands.hpp"

namespace sysid {
namespace {

std::vector<ExperimentData> load(Session& session, FitTask const& fit, std::vector<ExperimentUse> const& uses, StartRule start,
                                 PredictionRule rule) {
  return load_experiments(session, uses, session.file.models[static_cast<std::size_t>(fit.model)], start, rule, fit.solver);
}

}  // namespace

ProcessTrajectories::ProcessTrajectories(Session& session, PredictTask const& what, std::uint64_t seed)
    : session_(session),
      what_(what),
      fitted_(fitted_model(session, what.fit)),
      fit_(std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what)),
      trained_(process_target(fit_, process_model(session, fit_, fit_.prediction),
                              experiments_of(load(session, fit_, fit_.experiments, fit_.start, fit_.prediction)), fitted_.solver,
                              session.abandonable())),
      model_(process_model(session, fit_, what.prediction)),
      space_(parameter_space(model_->model(), fit_.experiments)),
      data_(load(session, fit_, what.experiments, what.start, what.prediction)),
      seed_(seed) {}

LaneArray ProcessTrajectories::draws() const {
  return spread(fitted_.draws, std::min<int>(what_.draws, static_cast<int>(fitted_.draws.total())));
}

LaneArray ProcessTrajectories::parameters(int e) const {
  LaneArray const declared = draws();
  int const fitted = what_.fitted[static_cast<std::size_t>(e)];
  if (fitted < 0)
    return space_->of_new_experiment(declared, data_[static_cast<std::size_t>(e)].use.constants,
                                     {seed_, Purpose::population, static_cast<std::uint64_t>(e) << 32, 0});
  LaneArray own(static_cast<int>(model().parameters.size()), declared.width());
  space_->select(space_->values_of_declared(declared), fitted, own);
  return own;
}

ProcessForecast ProcessTrajectories::forecast(int e) const {
  return {trained_,
          model_,
          data_[static_cast<std::size_t>(e)].experiment,
          fitted_.solver,
          start_rows(what_.start),
          session_.abandonable()};
}

Trajectory::Result ProcessTrajectories::run(int e, ProcessForecast const& forecast, ConstLanes parameters) const {
  LaneArray const spread_draws = draws();
  require_free_run_work(session_, *trained_, *model_, data_[static_cast<std::size_t>(e)].experiment.time.size(),
                        spread_draws.width());
  return forecast_draws(forecast, *space_, spread_draws, parameters, what_.draws, prediction_noise(seed_, e));
}

}  // namespace sysid
