// Stored draws as they are; everything else from them by simulation.
#include "exchange/inference_data.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/bands.hpp"
#include "app/derived_draws.hpp"
#include "app/experiments.hpp"
#include "app/fit_target.hpp"
#include "app/posterior_trajectories.hpp"
#include "app/stored_draws.hpp"
#include "exchange/draws_group.hpp"
#include "exchange/sample_groups.hpp"
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
class StoredFit {
 public:
  StoredFit(Session& session, int index)
      : session(session),
        what(std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(index)].what)),
        fitted(fitted_model(session, index)),
        compiled(
            session.compiled(what.model, what.start.kind == StartRule::Kind::estimated, fitted.solver.method, what.prediction)),
        space(parameter_space(compiled->model, what.experiments)),
        data(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                              what.prediction)) {}

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

NetcdfGroup log_likelihood(StoredFit const& fit, std::vector<std::size_t> const& numbers) {
  NetcdfGroup group("log_likelihood");
  add_draw_dimensions(group, fit.fitted.draws.chains.size(), numbers);
  LaneArray const declared = columns_of(fit.fitted.draws, numbers);
  for (std::size_t e = 0; e < fit.data.size(); ++e) {
    Experiment const& experiment = fit.data[e].experiment;
    PointwiseLikelihood const pointwise(fit.compiled, experiment, fit.fitted.solver, start_rows(fit.what.start),
                                        fit.session.options.execution);
    auto const values = pointwise.run(fit.parameters(e, declared));
    RowsOfExperiment const scored = scored_rows(experiment, fit.model().dynamics, fit.label(e));
    for (std::size_t c = 0; c < fit.model().channels.size(); ++c) {
      RowsOfExperiment rows = scored;
      rows.rows = pointwise.samples(static_cast<int>(c));
      if (rows.rows.empty()) continue;
      // A sample that is missing has no density: such a channel has rows of its own.
      if (rows.rows != scored.rows) {
        std::string const& name = fit.model().channels[c].name;
        rows.dimension = labelled("row_" + name, fit.label(e));
        if (!rows.time.empty()) rows.time = labelled("time_" + name, fit.label(e));
      }
      bool const there = std::any_of(group.dimensions().begin(), group.dimensions().end(),
                                     [&](auto const& each) { return each.first == rows.dimension; });
      if (!there) add_rows(group, experiment, rows);
      std::vector<double> flat;
      for (auto const& draw : values[c]) flat.insert(flat.end(), draw.begin(), draw.end());
      group.add({labelled(fit.model().channels[c].name, fit.label(e)),
                 {"chain", "draw", rows.dimension},
                 std::move(flat),
                 row_attributes("", rows)});
    }
  }
  return group;
}

/// Trajectories along all experiments of declared values, lane by lane over chains and draws, which the group's dimensions are.
void add_predictive(NetcdfGroup& group, StoredFit const& fit, ConstLanes declared, std::uint64_t seed) {
  for (std::size_t e = 0; e < fit.data.size(); ++e) {
    Experiment const& experiment = fit.data[e].experiment;
    RowsOfExperiment const rows = scored_rows(experiment, fit.model().dynamics, fit.label(e));
    add_rows(group, experiment, rows);
    Trajectory const trajectory(fit.compiled, experiment, fit.fitted.solver, start_rows(fit.what.start),
                                fit.session.options.execution);
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

std::vector<std::size_t> all_numbers(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
  return numbers;
}

}  // namespace

Attributes provenance(StoredResult const& stored) {
  return {{"inference_library", "sysid"},
          {"inference_library_version", stored.summary["versions"].value("sysid", std::string())},
          {"task", stored.task()},
          {"what", stored.what()},
          {"model", stored.summary.value("model", std::string())},
          {"seed", std::to_string(stored.seed())}};
}

InferenceData stored_inference_data(StoredResult const& stored) {
  InferenceData data{provenance(stored), {}, {}};
  Draws const draws = stored_draws(stored);
  NetcdfGroup posterior("posterior"), stats("sample_stats");
  add_draws(posterior, draws);
  add_chain_dimensions(stats, draws.chains.size(), draws.chains.front().values.size());
  auto const add = [&](char const* name, std::vector<double> Chain::*member) {
    std::vector<double> values;
    for (Chain const& chain : draws.chains) values.insert(values.end(), (chain.*member).begin(), (chain.*member).end());
    stats.add({name, {"chain", "draw"}, std::move(values), {}});
  };
  add("lp", &Chain::log_density);
  add("acceptance_rate", &Chain::acceptance);
  add("log_prior", &Chain::log_prior);
  add("log_likelihood", &Chain::log_likelihood);
  data.add(std::move(posterior));
  data.add(std::move(stats));
  return data;
}

void add_data(Session& session, FitTask const& fit, InferenceData& data) {
  Model const& model = session.file.models[static_cast<std::size_t>(fit.model)];
  NetcdfGroup observed("observed_data"), constant("constant_data");
  auto const experiments = load_experiments(session, fit.experiments, model, fit.start, fit.prediction);
  for (ExperimentData const& each : experiments) {
    std::string const label = experiments.size() > 1 ? each.experiment.name : std::string();
    RowsOfExperiment const rows = scored_rows(each.experiment, model.dynamics, label);
    for (NetcdfGroup* group : {&observed, &constant}) add_rows(*group, each.experiment, rows);
    add_measured(observed, model, each.experiment, rows, "", label);
    add_inputs(constant, model, each.experiment, rows, label);
  }
  data.add(std::move(observed));
  data.add(std::move(constant));
}

void add_simulated(Session& session, int index, StoredResult const& stored, int draws, InferenceData& data) {
  FitTask const& what = std::get<FitTask>(session.file.tasks[static_cast<std::size_t>(index)].what);
  fitted_model(session, index);  // refuses results of another text or other data before anything is added
  add_data(session, what, data);
  if (!session.file.models[static_cast<std::size_t>(what.model)].processes.empty()) {
    data.left_out.push_back(
        "log_likelihood, posterior_predictive, prior, prior_predictive: with an unknown function over the rows "
        "the samples have a joint density alone, and its draws are not stored");
    return;
  }
  StoredFit const fit(session, index);
  std::vector<std::size_t> const numbers = spread_over_chain(fit.fitted.draws, draws);
  data.add(log_likelihood(fit, numbers));
  NetcdfGroup predictive("posterior_predictive");
  add_draw_dimensions(predictive, fit.fitted.draws.chains.size(), numbers);
  add_predictive(predictive, fit, columns_of(fit.fitted.draws, numbers), stored.seed());
  data.add(std::move(predictive));
  for (Parameter const& parameter : fit.model().parameters)
    if (parameter.prior && !parameter.prior->row->proper) {
      data.left_out.push_back(fmt::format("prior, prior_predictive: that of `{}` is {}, which cannot be drawn from", parameter.name,
                                          parameter.prior->row->name));
      return;
    }
  Draws const drawn = prior_draws(fit, draws, stored.seed());
  NetcdfGroup prior("prior"), prior_predictive("prior_predictive");
  add_draws(prior, drawn);
  data.add(std::move(prior));
  std::vector<std::size_t> const all = all_numbers(drawn.total());
  add_draw_dimensions(prior_predictive, 1, all);
  add_predictive(prior_predictive, fit, columns_of(drawn, all), stored.seed());
  data.add(std::move(prior_predictive));
}

void add_predictions(Session& session, std::vector<std::pair<Task const*, StoredResult>> const& tasks, InferenceData& data) {
  if (tasks.empty()) return;
  NetcdfGroup predictions("predictions"), constant("predictions_constant_data");
  std::vector<std::unique_ptr<PosteriorTrajectories>> all;
  for (auto const& [task, stored] : tasks)
    all.push_back(std::make_unique<PosteriorTrajectories>(session, std::get<PredictTask>(task->what), stored.seed()));
  // One number of trajectories for all of a group: the first task's.
  int const draws = all.front()->wanted();
  add_draw_dimensions(predictions, 1, all_numbers(static_cast<std::size_t>(draws)));
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    PosteriorTrajectories const& of_task = *all[t];
    if (of_task.wanted() != draws) {
      data.left_out.push_back(fmt::format("predictions of `{}`: it has {} trajectories, that of `{}` {}", tasks[t].first->name,
                                          of_task.wanted(), tasks.front().first->name, draws));
      continue;
    }
    for (std::size_t e = 0; e < of_task.data().size(); ++e) {
      Experiment const& experiment = of_task.data()[e].experiment;
      std::string label = tasks.size() > 1 ? tasks[t].first->name : std::string();
      if (of_task.data().size() > 1) label += (label.empty() ? "" : ",") + experiment.name;
      RowsOfExperiment const rows = scored_rows(experiment, of_task.model().dynamics, label);
      for (NetcdfGroup* group : {&predictions, &constant}) add_rows(*group, experiment, rows);
      Trajectory const trajectory = of_task.trajectory(static_cast<int>(e));
      add_trajectories(predictions, of_task.model(), trajectory.quantities(),
                       of_task.run(static_cast<int>(e), trajectory, of_task.parameters(static_cast<int>(e))), rows, label);
      add_inputs(constant, of_task.model(), experiment, rows, label);
      add_measured(constant, of_task.model(), experiment, rows, "_measured", label);
    }
  }
  data.add(std::move(predictions));
  data.add(std::move(constant));
}

}  // namespace sysid
