// Built from the parts of a fit, so that it is the fit's density and not a second one.
#include "app/density/fit_density.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/fit/fit_preparation.hpp"
#include "app/session/exact_steps.hpp"
#include "app/session/fit_target.hpp"
#include "app/session/reporting.hpp"
#include "app/session/task_checkpoint.hpp"
#include "diagnostics/bands.hpp"
#include "inference/table.hpp"
#include "search/journal.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr std::uint64_t before_any_seed = 0;  // of what no value of a density reads

[[noreturn]] void no_function(Task const& task, std::string why, std::string help) {
  throw UserError({Severity::error,
                   "E6212",
                   fmt::format("`{}` cannot be used as a function: {}", task.name, why),
                   Label{task.span, {}},
                   {},
                   std::move(help),
                   {task.name}});
}

}  // namespace

FitDensity::FitDensity(Session& session, int index)
    : session_(session),
      task_(session.file.tasks[static_cast<std::size_t>(index)]),
      what_(with_exact_steps(session, std::get<FitTask>(task_.what)).task) {
  if (what_.filter == FilterRule::particle)
    no_function(task_, "its likelihood is estimated by particles, with random numbers", "use a filter that computes it");
  Model const& model = session.file.models[static_cast<std::size_t>(what_.model)];
  data_ = load_experiments(session, what_.experiments, model, what_.start, what_.prediction, what_.solver);
  likelihood_ = model.processes.empty() ? independent_likelihood(session, what_, data_, before_any_seed)
                                        : process_likelihood(session, what_, data_, before_any_seed);
  preparation_.solver = what_.solver;
  set_target();
}

bool FitDensity::prepare(std::uint64_t seed) {
  BackendRow const* const backend = find_backend(what_.backend);
  TaskCheckpoint checkpoint(session_, task_, Unkept{seed});
  FitPreparation preparing(session_, task_, what_, data_, *likelihood_, backend->objective_kind, checkpoint);
  Preparation found;
  RunContext context{.seed = seed, .progress = session_.progress, .ledger = found.ledger, .interrupted = [this] {
                       return session_.interrupted();
                     }};
  bool const prepared = checkpoint.keep_steps(
      nullptr,
      [](json const& steps) -> json {
        return {{"journal", steps}};
      },
      [&](Journal& journal) {
        context.journal = &journal;
        return preparing.run(context, found);
      });
  if (prepared) preparation_ = std::move(found);
  set_target();
  return prepared;
}

void FitDensity::set_target() {
  target_ = &likelihood_->set_target(preparation_.solver, session_.interruptible());
  if (likelihood_->model().processes.empty()) compiled_ = session_.compiled(what_, preparation_.solver.method);
}

std::vector<PriorInfo> FitDensity::priors() const {
  std::vector<PriorInfo> const all = priors_of(likelihood_->space(), declared_priors(session_, what_.model));
  std::vector<PriorInfo> sampled;
  for (ParameterInfo const& each : target_->parameters())
    for (PriorInfo const& prior : all)
      if (prior.name == each.name) sampled.push_back(prior);
  return sampled;
}

std::string FitDensity::name(int e) const {
  auto const& use = data_[static_cast<std::size_t>(e)].use;
  return data_name(session_.file.data[static_cast<std::size_t>(use.data)], use.part);
}

std::vector<double> const& FitDensity::time(int e) const { return data_[static_cast<std::size_t>(e)].experiment.time; }

FitDensity::Simulated FitDensity::simulate(int e, ConstLanes declared, std::uint64_t seed) const {
  Model const& model = likelihood_->model();
  if (!compiled_) no_function(task_, "a Gaussian process is part of what it predicts", "predict with a `predict` task instead");
  Experiment const& experiment = data_[static_cast<std::size_t>(e)].experiment;
  ParameterSpace const& space = likelihood_->space();
  LaneArray parameters(static_cast<int>(model.parameters.size()), declared.width());
  space.select(space.values_of_declared(declared), e, parameters);
  Trajectory const trajectory(compiled_, experiment, preparation_.solver, start_rows(what_.start), session_.interruptible(),
                              [this](NodeId node, Graph const& graph) { return session_.describe(what_.model, graph, node); });
  return {name(e), experiment.time, trajectory.quantities(), trajectory.run(parameters, prediction_noise(seed, e))};
}

}  // namespace sysid
