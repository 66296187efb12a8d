// Fits with Gaussian processes: linear coefficients are integrated out and drawn afterwards; scores are leave-one-out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/fit/fit_likelihood.hpp"
#include "app/process/process_draws.hpp"
#include "app/process/process_fit.hpp"
#include "app/process/process_functions.hpp"
#include "app/process/process_scores.hpp"
#include "app/session/derived_draws.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/fit_target.hpp"
#include "diagnostics/bands.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/table.hpp"

namespace sysid {
namespace {

std::vector<double> parameters_of_best(Draws const& draws) {
  std::vector<double> best = best_draw(draws);
  best.resize(static_cast<std::size_t>(draws.parameter_count));
  return best;
}

class ProcessLikelihood : public FitLikelihood {
 public:
  ProcessLikelihood(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, std::uint64_t seed)
      : session_(session),
        what_(what),
        data_(data),
        seed_(seed),
        model_(process_model(session, what, what.prediction)),
        space_(parameter_space(model_->model(), what.experiments)) {
    require_process_work(session, *model_, data);
  }

  Model const& model() const override { return model_->model(); }
  Model const& sampled_model() const override { return model_->reduced(); }
  ParameterSpace const& space() const override { return *space_; }
  // What the data say of a member alone is not known: its likelihood is no sum of squares.
  ParameterSpace const* with_hierarchies() const override { return nullptr; }
  void standardise(std::vector<MemberCoordinate> const& members) override {
    if (!members.empty()) throw checkpoint::Mismatch("its hierarchies differ");
  }
  // No fit with one begins.
  void refer(std::vector<ImproperReference> const& references) override {
    if (!references.empty()) throw checkpoint::Mismatch("its improper priors differ");
  }

  std::unique_ptr<Target> make_target(std::vector<Experiment> experiments, SolverSettings const& solver,
                                      ExecutionOptions const& execution) const override {
    if (solver.method == what_.solver.method) return process_target(what_, model_, std::move(experiments), solver, execution);
    FitTask other = what_;
    other.solver = solver;
    return process_target(other, process_model(session_, other, other.prediction), std::move(experiments), solver, execution);
  }

  std::vector<std::vector<double>> log_densities(std::vector<Experiment> const&, SolverSettings const&,
                                                 std::vector<double> const&) const override {
    return {};
  }

  std::unique_ptr<PointwiseLikelihood> pointwise(int) const override { return nullptr; }

  Target const& set_target(SolverSettings const& solver, ExecutionOptions const& execution) override {
    solver_ = solver;
    target_ = process_target(what_, model_, experiments_of(data_), solver, execution);
    return *target_;
  }

  Draws draws(FitResult const& result) const override {
    Draws draws = with_coefficients(*target_, *space_, result.draws, seed_);
    add_derived(*compile_parametric(*model_, start_rows(what_.start) > 0, what_.solver.method), *space_, draws);
    return draws;
  }

  // Of what was sampled as the back end has them, of what was integrated out from the draws; at an optimum its sd given the rest.
  std::vector<Summary> summaries(FitResult const& result, Draws const& draws) const override {
    std::vector<Summary> const sampled = summarise(result);
    auto const sds = draws.is_optimum() ? coefficient_sds(*target_, *space_, parameters_of_best(draws))
                                        : std::vector<std::pair<std::string, double>>{};
    std::vector<Summary> summaries;
    for (std::size_t p = 0; p < space_->infos().size(); ++p) {
      std::string const& name = space_->infos()[p].name;
      auto const own = std::find_if(sampled.begin(), sampled.end(), [&](Summary const& each) { return each.name == name; });
      summaries.push_back(own != sampled.end() ? *own : of_column(draws, p));
      for (auto const& [coefficient, sd] : sds)
        if (coefficient == name) summaries.back().sd = sd;
    }
    return summaries;
  }

  FitCheck check_residuals(FitResult const&, Draws const& draws) const override {
    return score_leave_one_out(*target_, *space_, parameters_of_best(draws), data_);
  }

  std::vector<FunctionReport> functions(FitResult const&, Draws const& draws) const override {
    return process_functions(*target_, *space_, draws);
  }

  // A model with processes has no finite sums.
  Findings check_functions(FitResult const&) const override { return {}; }
  Findings check_ranges(std::vector<double> const&, SolverSettings const&) const override { return {}; }

  FittedRows fitted_rows(Draws const& draws, int e, std::vector<RestoringForce>&) const override {
    Experiment const& experiment = data_[static_cast<std::size_t>(e)].experiment;
    ProcessForecast const forecast(target_, model_, experiment, solver_, start_rows(what_.start), session_.interruptible());
    LaneArray const columns = spread(draws, 100);
    LaneArray own(static_cast<int>(model().parameters.size()), columns.width());
    space_->select(space_->values_of_declared(columns), e, own);
    Trajectory::Result const result = forecast_draws(forecast, *space_, columns, own, 100, prediction_noise(seed_, e));
    // Constraints beside processes are refused by the checker (E3217), so that nothing can drift.
    FittedRows rows{bands_along(forecast.quantities(), result, experiment, model()), {}, {}};
    rows.bands = channel_band_findings(rows.prediction, model(), 0, data_.size() > 1);  // no other finding reports failures here
    return rows;
  }

  std::optional<Prediction> states(Draws const&, int) const override { return std::nullopt; }

  Facts settings() const override {
    auto const marginalised = model_->marginalised();
    if (marginalised.empty()) return {};
    return {{"integrated_out", fmt::format("{}", fmt::join(marginalised, ", "))}};
  }

 private:
  Session& session_;
  FitTask const& what_;
  std::vector<ExperimentData> const& data_;
  std::uint64_t seed_;
  std::shared_ptr<ProcessModel const> model_;
  std::shared_ptr<ParameterSpace const> space_;
  SolverSettings solver_;
  std::shared_ptr<ProcessTarget const> target_;
};

}  // namespace

std::unique_ptr<FitLikelihood> process_likelihood(Session& session, FitTask const& what, std::vector<ExperimentData> const& data,
                                                  std::uint64_t seed) {
  return std::make_unique<ProcessLikelihood>(session, what, data, seed);
}

}  // namespace sysid
