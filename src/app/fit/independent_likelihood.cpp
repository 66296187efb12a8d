// Fits whose samples are independent given the trajectory.
#include <algorithm>
#include <cmath>

#include "app/fit/fit_likelihood.hpp"
#include "app/fit/fitted_particles.hpp"
#include "app/fit/smoothed_states.hpp"
#include "app/process/unknown_functions.hpp"
#include "app/session/derived_draws.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/lazily.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"
#include "experiment/noise_statement.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/table.hpp"
#include "likelihood/trajectory.hpp"
#include "mechanics/restoring_force.hpp"

namespace sysid {
namespace {

class IndependentLikelihood : public FitLikelihood {
 public:
  IndependentLikelihood(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, std::uint64_t seed)
      : session_(session),
        what_(what),
        data_(data),
        seed_(seed),
        compiled_(session.compiled(what, what.solver.method)),
        declared_(parameter_space(compiled_->model, what.experiments)),
        space_(declared_) {
    if (what.filter == FilterRule::particle) particles_.emplace(session, what, compiled_->model, data, seed);
  }

  Model const& model() const override { return compiled_->model; }
  Model const& sampled_model() const override { return compiled_->model; }
  ParameterSpace const& space() const override { return *space_; }
  ParameterSpace const* with_hierarchies() const override { return declared_->members().empty() ? nullptr : declared_.get(); }
  void standardise(std::vector<MemberCoordinate> const& members) override {
    for (MemberCoordinate const& each : members)
      if (std::none_of(declared_->members().begin(), declared_->members().end(),
                       [&](ParameterSpace::Member const& member) { return member.coordinate == each.coordinate; }) ||
          !(each.precision >= 0 && std::isfinite(each.precision) && std::isfinite(each.pull)))
        throw checkpoint::Mismatch("its hierarchies differ");
    space_ =
        members.empty()
            ? declared_
            : std::make_shared<ParameterSpace const>(
                  ParameterSpace(declared_->model(), declared_->experiments(), members).with_references(declared_->references()));
  }
  void refer(std::vector<ImproperReference> const& references) override {
    std::vector<int> wanted = improper_coordinates(declared_->infos()), given;
    for (ImproperReference const& each : references) given.push_back(each.coordinate);
    if (given != wanted) throw checkpoint::Mismatch("its improper priors differ");
    if (references.empty()) return;
    declared_ = std::make_shared<ParameterSpace const>(declared_->with_references(references));
    space_ = declared_;
  }

  std::unique_ptr<Target> make_target(std::vector<Experiment> experiments, SolverSettings const& solver,
                                      ExecutionOptions const& execution) const override {
    return make_fit_target(session_, what_, compiled_for(solver), space_, std::move(experiments), solver, execution);
  }

  std::unique_ptr<Target> with_filter(FilterRule filter, std::vector<Experiment> experiments, SolverSettings const& solver,
                                      ExecutionOptions const& execution) const override {
    FitTask other = what_;
    other.filter = filter;
    return make_fit_target(session_, what_, session_.compiled(other, solver.method), space_, std::move(experiments), solver,
                           execution);
  }

  std::shared_ptr<ParticleTarget const> by_particles(std::vector<Experiment> experiments, SolverSettings const& solver,
                                                     ExecutionOptions const& execution) const override {
    return std::make_shared<ParticleTarget const>(particle_model(model(), solver.method), space_, std::move(experiments),
                                                  fit_target_options(session_, what_, solver, execution));
  }

  std::vector<std::vector<double>> log_densities(std::vector<Experiment> const& experiments, SolverSettings const& solver,
                                                 std::vector<double> const& sampled) const override {
    std::vector<std::vector<double>> all;
    for (int e = 0; e < static_cast<int>(experiments.size()); ++e) {
      PointwiseLikelihood const pointwise(compiled_for(solver), experiments[static_cast<std::size_t>(e)], solver,
                                          start_rows(what_.start), session_.interruptible());
      for (auto& channel : pointwise.run(parameters_at(sampled, e))) all.push_back(std::move(channel.front()));
    }
    return all;
  }

  std::unique_ptr<PointwiseLikelihood> pointwise(int e) const override {
    return std::make_unique<PointwiseLikelihood>(compiled_, experiment(e), solver_, start_rows(what_.start),
                                                 session_.interruptible());
  }

  void know_modes(std::vector<Mode> const& modes) override { modes_ = modes; }
  std::string estimated_by() const override { return particles_ ? particles_->chosen() : std::string(); }
  FinerEstimates finer_estimates(ExecutionOptions const& execution) const override {
    if (!particles_) return {};
    return {particles_->with_solver(space_, solver_, execution), particles_->with_solver(space_, solver_.finer(), execution)};
  }
  Findings check_particles(FitResult const& result) const override {
    return particles_ ? particles_->check(parameters_of_each(middle_of(result)), spread(result.draws, 12)) : Findings();
  }

  Target const& set_target(SolverSettings const& solver, ExecutionOptions const& execution) override {
    solver_ = solver;
    target_ = make_fit_target(session_, what_, compiled_, space_, experiments_of(data_), solver, execution);
    return particles_ ? particles_->set_target(space_, solver, execution, modes_) : *target_;
  }

  Draws draws(FitResult const& result) const override {
    Draws draws = result.draws;
    add_derived(*compiled_, *space_, draws);
    return draws;
  }

  std::vector<Summary> summaries(FitResult const& result, Draws const&) const override {
    std::vector<Summary> summaries = summarise(result);
    for (std::size_t p = 0; p < summaries.size(); ++p) summaries[p].coefficient = target_->parameters()[p].coefficient;
    return summaries;
  }

  FitCheck check_residuals(FitResult const& result, Draws const&) const override {
    if (particles_) return particles_->check_residuals(parameters_of_each(middle_of(result)));
    Source const& source = session_.source;
    UserText const text{
        .mentions = [&](std::string const& name) { return mentions(source, name); },
        .noise_statement_with = [&](Channel const& channel,
                                    std::string const& sum) { return noise_statement_with(source, channel, sum); },
        .time_name = [&](Channel const& channel) { return time_name(source, channel); },
        .heavy_tailed = [&](Channel const& channel) { return heavy_tailed_statement(source, channel); },
        .proportional = [&](Channel const& channel,
                            std::string const& relative) { return proportional_statement(source, channel, relative); },
        .overdispersed = [&](Channel const& channel,
                             std::string const& shape) { return overdispersed_statement(source, channel, shape); }};
    return sysid::check_residuals(*target_, best_of(result), text);
  }

  std::vector<FunctionReport> functions(FitResult const& result, Draws const&) const override {
    if (model().expansions.empty()) return {};
    std::vector<FunctionReport> functions = unknown_functions(model(), function_parameters(*space_, result));
    for (int e = 0; e < static_cast<int>(data_.size()); ++e)
      add_visits(model(), experiment(e), solver_, start_rows(what_.start), parameters_at(best_of(result), e),
                 session_.interruptible(), functions);
    return functions;
  }

  Findings check_functions(FitResult const& result) const override {
    Findings findings = check_expansions(model(), function_parameters(*space_, result).values);
    Findings const ranges = check_ranges(best_of(result), solver_);
    findings.insert(findings.end(), ranges.begin(), ranges.end());
    return findings;
  }

  Findings check_ranges(std::vector<double> const& sampled, SolverSettings const& solver) const override {
    Findings findings;
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) {
      Findings const more = sysid::check_ranges(model(), experiment(e), solver, start_rows(what_.start), parameters_at(sampled, e),
                                                session_.interruptible());
      findings.insert(findings.end(), more.begin(), more.end());
    }
    return findings;
  }

  FittedRows fitted_rows(Draws const& draws, int e, std::vector<RestoringForce>& forces) const override {
    LaneArray const columns = spread(draws, 100);
    LaneArray parameters(static_cast<int>(model().parameters.size()), columns.width());
    space_->select(space_->values_of_declared(columns), e, parameters);
    Trajectory const trajectory(compiled_, experiment(e), solver_, start_rows(what_.start), session_.interruptible());
    Trajectory::Result const result =
        particles_ ? particles_->along(e, parameters) : trajectory.run(parameters, prediction_noise(seed_, e));
    FittedRows rows{bands_along(trajectory.quantities(), result, experiment(e), model()),
                    drift_findings(session_.source, model(), result, experiment(e).name),
                    {}};
    rows.bands = band_findings(rows.prediction, result.failed(), result.failed(), data_.size() > 1);
    add_restoring_forces(model(), trajectory.quantities(), result, parameters, experiment(e), forces);
    return rows;
  }

  std::optional<Prediction> states(Draws const& draws, int e) const override {
    if (!model().filtered()) return std::nullopt;
    LaneArray const columns = spread(draws, 100);
    LaneArray parameters(static_cast<int>(model().parameters.size()), columns.width());
    space_->select(space_->values_of_declared(columns), e, parameters);
    if (particles_) return particles_->states(e, parameters);
    auto const& smoothing = smoothing_.get([&] { return compile_smoothing(compiled_); });
    return smoothed_states(smoothing, experiment(e), solver_, start_rows(what_.start), session_.interruptible(), parameters);
  }

  Facts settings() const override { return particles_ ? particles_->settings() : Facts(); }

 private:
  std::shared_ptr<CompiledModel const> compiled_for(SolverSettings const& solver) const {
    if (solver.method == what_.solver.method) return compiled_;
    return session_.compiled(what_, solver.method);
  }

  Experiment const& experiment(int e) const { return data_[static_cast<std::size_t>(e)].experiment; }

  static std::vector<double> best_of(FitResult const& result) {
    return result.modes.empty() ? best_draw(result.draws) : result.modes.front().declared;
  }

  // The means of the draws: no estimate of a likelihood tells which place is the best.
  static std::vector<double> middle_of(FitResult const& result) {
    if (result.draws.total() < 2) return best_of(result);
    std::vector<double> middle;
    for (int p = 0; p < result.draws.parameter_count; ++p) middle.push_back(mean(result.draws.column(static_cast<std::size_t>(p))));
    return middle;
  }

  // Those of the model in an experiment, SI, of the sampled ones, declared.
  LaneArray parameters_at(std::vector<double> const& values, int e) const {
    LaneArray declared(static_cast<int>(values.size()), 1), one(static_cast<int>(model().parameters.size()), 1);
    for (std::size_t p = 0; p < values.size(); ++p) declared(static_cast<int>(p), 0) = values[p];
    space_->select(space_->values_of_declared(declared), e, one);
    return one;
  }

  std::vector<LaneArray> parameters_of_each(std::vector<double> const& values) const {
    std::vector<LaneArray> all;
    for (int e = 0; e < static_cast<int>(data_.size()); ++e) all.push_back(parameters_at(values, e));
    return all;
  }

  Session& session_;
  FitTask const& what_;
  std::vector<ExperimentData> const& data_;
  std::uint64_t seed_;
  std::shared_ptr<CompiledModel const> compiled_;
  std::shared_ptr<ParameterSpace const> declared_, space_;
  SolverSettings solver_;
  std::unique_ptr<ModelTarget> target_;
  Lazily<std::shared_ptr<SmoothingProgram const>> smoothing_;
  std::optional<FittedParticles> particles_;  // of `filter = particle`; the targets above then serve the search
  std::vector<Mode> modes_;
};

}  // namespace

std::unique_ptr<FitLikelihood> independent_likelihood(Session& session, FitTask const& what,
                                                      std::vector<ExperimentData> const& data, std::uint64_t seed) {
  return std::make_unique<IndependentLikelihood>(session, what, data, seed);
}

}  // namespace sysid
