// One way into the groups for trajectories of fits, of processes and of selections.
#include "exchange/predictions_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "app/process/process_trajectories.hpp"
#include "app/selection/selection_trajectories.hpp"
#include "app/session/posterior_trajectories.hpp"
#include "exchange/draws_group.hpp"
#include "exchange/sample_groups.hpp"

namespace sysid {
namespace {

/// Trajectories along one of the experiments of a task.
struct Along {
  Model const& model;
  ExperimentData const& data;
  std::span<TrajectoryQuantity const> quantities;
  Trajectory::Result const& result;
  bool several;  // experiments
};
using Take = std::function<void(Along const&)>;

std::size_t trajectories_of(Along const& along) { return along.result.values.empty() ? 0 : along.result.values.front().size(); }

void of_fit(Session& session, PredictTask const& what, std::uint64_t seed, Take const& take) {
  PosteriorTrajectories const all(session, what, seed);
  for (int e = 0; e < static_cast<int>(all.data().size()); ++e) {
    Trajectory const trajectory = all.trajectory(e);
    take({all.model(), all.data()[static_cast<std::size_t>(e)], trajectory.quantities(), all.run(e, trajectory, all.parameters(e)),
          all.data().size() > 1});
  }
}

void of_processes(Session& session, PredictTask const& what, std::uint64_t seed, Take const& take) {
  ProcessTrajectories const all(session, what, seed);
  for (int e = 0; e < static_cast<int>(all.data().size()); ++e) {
    ProcessForecast const forecast = all.forecast(e);
    take({all.model(), all.data()[static_cast<std::size_t>(e)], forecast.quantities(), all.run(e, forecast, all.parameters(e)),
          all.data().size() > 1});
  }
}

void of_candidate(Session& session, StoredPrediction const& task, std::size_t candidate, Take const& take) {
  SelectionTrajectories const all(session, task.what, task.seed);
  std::size_t const experiments = task.what.candidate_experiments[candidate].size();
  if (all.counts()[candidate] == 0) return;
  for (std::size_t e = 0; e < experiments; ++e) {
    SelectionTrajectories::Along const along = all.along(candidate, e);
    take({along.model(), *along.data, along.trajectory->quantities(), along.result, experiments > 1});
  }
}

/// Groups of trajectories that are equally many.
struct Groups {
  std::size_t trajectories;
  NetcdfGroup predictions, constant;
};

class Collected {
 public:
  void add(StoredPrediction const& task, bool several_tasks, Along const& along) {
    Groups& groups = of_size(trajectories_of(along), task.task.name);
    std::string label = several_tasks ? task.task.name : std::string();
    if (along.several) label += (label.empty() ? "" : ",") + along.data.experiment.name;
    RowsOfExperiment const rows = scored_rows(along.data.experiment, along.model.dynamics, label);
    for (NetcdfGroup* group : {&groups.predictions, &groups.constant}) add_rows(*group, along.data.experiment, rows);
    add_trajectories(groups.predictions, along.model, along.quantities, along.result, rows, label);
    add_inputs(groups.constant, along.model, along.data.experiment, rows, label);
    add_constants(groups.constant, along.model, along.data.use, label);
    add_measured(groups.constant, along.model, along.data.experiment, rows, "_measured", label);
  }

  void into(InferenceData& data) {
    for (Groups& groups : all_) {
      data.add(std::move(groups.predictions));
      data.add(std::move(groups.constant));
    }
  }

 private:
  Groups& of_size(std::size_t trajectories, std::string const& task) {
    for (Groups& groups : all_)
      if (groups.trajectories == trajectories) return groups;
    std::string const suffix = all_.empty() ? "" : "_" + task;
    all_.push_back({trajectories, NetcdfGroup("predictions" + suffix), NetcdfGroup("predictions_constant_data" + suffix)});
    add_chain_dimensions(all_.back().predictions, 1, trajectories);
    return all_.back();
  }

  std::vector<Groups> all_;
};

bool has_processes(Session const& session, PredictTask const& what) {
  auto const& fit = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(what.fit)].what);
  return !session.file.models[static_cast<std::size_t>(fit.model)].processes.empty();
}

}  // namespace

void add_predictions(Session& session, std::vector<StoredPrediction> const& tasks, InferenceData& data) {
  Collected collected;
  for (StoredPrediction const& task : tasks)
    (has_processes(session, task.what) ? of_processes : of_fit)(
        session, task.what, task.seed, [&](Along const& along) { collected.add(task, tasks.size() > 1, along); });
  collected.into(data);
}

void add_predictions(Session& session, std::vector<StoredPrediction> const& tasks, std::size_t candidate, InferenceData& data) {
  Collected collected;
  for (StoredPrediction const& task : tasks)
    of_candidate(session, task, candidate, [&](Along const& along) { collected.add(task, tasks.size() > 1, along); });
  collected.into(data);
}

void add_process_predictive(Session& session, int fit, std::uint64_t seed, int draws, InferenceData& data) {
  FitTask const& what = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(fit)].what);
  PredictTask along_the_record;
  along_the_record.fit = fit;
  along_the_record.experiments = what.experiments;
  along_the_record.fitted.resize(what.experiments.size());
  std::iota(along_the_record.fitted.begin(), along_the_record.fitted.end(), 0);
  along_the_record.draws = std::max(1, draws);
  along_the_record.start = what.start;
  along_the_record.prediction = what.prediction;
  NetcdfGroup group("posterior_predictive");
  of_processes(session, along_the_record, seed, [&](Along const& along) {
    add_chain_dimensions(group, 1, trajectories_of(along));
    RowsOfExperiment const rows =
        scored_rows(along.data.experiment, along.model.dynamics, along.several ? along.data.experiment.name : std::string());
    add_rows(group, along.data.experiment, rows);
    add_trajectories(group, along.model, along.quantities, along.result, rows, along.several ? along.data.experiment.name : "");
  });
  data.add(std::move(group));
}

}  // namespace sysid
