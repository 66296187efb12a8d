// Batches of parameter vectors through the compiled kernels and programs; failures go to the ledger, never into a number.
#include "likelihood/model_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"
#include "likelihood/failures.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

// Keeps the radicand of the scale row positive for any sensible noise level; its value does not matter, only that it is fixed.
double scale_offset(int count) { return 100.0 * count + 1000.0; }

}  // namespace

struct ModelTarget::Part {
  Simulator likelihood, residuals;
  std::unique_ptr<StartState> start;
};

ModelTarget::~ModelTarget() = default;

ModelTarget::ModelTarget(std::shared_ptr<CompiledModel const> compiled, Experiment experiment, TargetOptions options)
    : ModelTarget(compiled,
                  std::make_shared<ParameterSpace const>(compiled->model, std::vector<ExperimentMember>{{experiment.name, {}}}),
                  std::vector<Experiment>{experiment}, std::move(options)) {}

ModelTarget::ModelTarget(std::shared_ptr<CompiledModel const> compiled, std::shared_ptr<ParameterSpace const> space,
                         std::vector<Experiment> experiments, TargetOptions options)
    : compiled_(std::move(compiled)),
      space_(std::move(space)),
      experiments_(std::move(experiments)),
      options_(std::move(options)),
      pool_(make_pool(options_.execution)) {
  if (compiled_->free_start != (options_.start_rows > 0)) throw InternalError("free start without rows to estimate it from");
  if (experiments_.size() != space_->experiments().size()) throw InternalError("parameters of other experiments");
  int const channels = static_cast<int>(compiled_->model.channels.size());
  for (int e = 0; e < static_cast<int>(experiments_.size()); ++e) {
    Experiment const& experiment = experiments_[static_cast<std::size_t>(e)];
    auto const simulator = [&](std::shared_ptr<SimulationProgram const> const& program) {
      return Simulator(program, Schedule(*program, experiment, options_.solver), options_.execution, pool_);
    };
    parts_.push_back({simulator(compiled_->likelihood), simulator(compiled_->residuals), nullptr});
    if (options_.start_rows > 0)
      parts_.back().start =
          std::make_unique<StartState>(compiled_, experiment, options_.start_rows, options_.solver, options_.execution, pool_);
    Schedule const& schedule = parts_.back().residuals.schedule();
    for (int c = 0; c < channels; ++c)
      for (int i = 0; i < schedule.samples(); ++i)
        if (schedule.summed(c, i)) places_.push_back({e, c, i});
    for (int c = 0; c < channels; ++c) places_.push_back({e, c, -1});
  }
}

std::vector<LaneArray> ModelTarget::simulation_parameters(ConstLanes theta) const {
  LaneArray const values = space_->values(theta);
  std::vector<LaneArray> all;
  for (int e = 0; e < static_cast<int>(parts_.size()); ++e) {
    all.emplace_back(compiled_->parameter_rows(), theta.width());
    space_->select(values, e, all.back());
  }
  auto const estimate = [&](int e) { parts_[static_cast<std::size_t>(e)].start->estimate(all[static_cast<std::size_t>(e)]); };
  if (options_.start_rows == 0) return all;
  // A single one leaves the threads to its simulations.
  if (pool_ && parts_.size() > 1)
    pool_->run(static_cast<int>(parts_.size()), estimate);
  else
    for (int e = 0; e < static_cast<int>(parts_.size()); ++e) estimate(e);
  return all;
}

void ModelTarget::record_failures(Simulator const& simulator, std::size_t experiment, LaneArray const& parameters,
                                  std::span<Outcome const> outcome, ConstLanes theta, Ledger& ledger) const {
  std::string const on_experiment = parts_.size() > 1 ? fmt::format(" on `{}`", experiments_[experiment].name) : std::string();
  LaneArray declared;
  auto const example = [&](int lane) {
    if (declared.rows() == 0) {
      declared = LaneArray(theta.rows(), theta.width());
      constrain(theta, declared);
    }
    std::vector<double> values;
    for (int p = 0; p < declared.rows(); ++p) values.push_back(declared(p, lane));
    return values;
  };
  sysid::record_failures({simulator, parameters, options_.start_rows > 0, on_experiment}, outcome, options_.describe, example,
                         ledger);
}

void ModelTarget::log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const {
  std::vector<LaneArray> const parameters = simulation_parameters(theta);
  auto const width = static_cast<std::size_t>(theta.width());
  std::vector<LaneArray> sums;
  std::vector<std::vector<Outcome>> outcome(parts_.size(), std::vector<Outcome>(width));
  for (Part const& part : parts_) sums.emplace_back(part.likelihood.program().sum_count(), theta.width());
  std::vector<Work> work;
  for (std::size_t e = 0; e < parts_.size(); ++e)
    work.push_back(parts_[e].likelihood.sums_work(parameters[e], sums[e], outcome[e]));
  do_work(work, pool_.get());
  all_or_nothing(ledger, [&] {
    for (std::size_t e = 0; e < parts_.size(); ++e)
      record_failures(parts_[e].likelihood, e, parameters[e], outcome[e], theta, ledger);
  });
  for (std::size_t w = 0; w < width; ++w) {
    double total = 0;
    bool good = true;
    for (std::size_t e = 0; e < parts_.size(); ++e) {
      good = good && outcome[e][w].ok;
      for (int row = 0; row < sums[e].rows(); ++row) total += sums[e](row, static_cast<int>(w));
    }
    out[w] = good && !std::isnan(total) ? total : -infinity;
  }
}

double ModelTarget::roughness() const {
  return compiled_->model.integrated() && !options_.solver.fixed_step() ? options_.solver.relative : 0;
}

int ModelTarget::residual_count() const { return static_cast<int>(places_.size()); }

void ModelTarget::residuals(ConstLanes theta, Lanes out, Ledger& ledger) const {
  std::vector<LaneArray> const parameters = simulation_parameters(theta);
  int const channels = static_cast<int>(compiled_->model.channels.size()), width = theta.width();
  std::vector<LaneArray> records, sums;
  std::vector<std::vector<Outcome>> outcome(parts_.size(), std::vector<Outcome>(static_cast<std::size_t>(width))), summed = outcome;
  for (Part const& part : parts_) {
    records.emplace_back(part.residuals.schedule().last_summed() * channels, width);
    sums.emplace_back(part.residuals.program().sum_count(), width);
  }
  std::vector<Work> work;
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    Simulator const& simulator = parts_[e].residuals;
    work.push_back(simulator.records_work(parameters[e], 0, simulator.schedule().last_summed(), records[e], outcome[e]));
    work.push_back(simulator.sums_work(parameters[e], sums[e], summed[e]));
  }
  do_work(work, pool_.get());
  std::vector<bool> good(static_cast<std::size_t>(width), true);
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    for (std::size_t w = 0; w < good.size(); ++w) {
      if (!summed[e][w].ok) outcome[e][w] = summed[e][w];
      good[w] = good[w] && outcome[e][w].ok;
    }
  }
  all_or_nothing(ledger, [&] {
    for (std::size_t e = 0; e < parts_.size(); ++e)
      record_failures(parts_[e].residuals, e, parameters[e], outcome[e], theta, ledger);
  });
  for (std::size_t r = 0; r < places_.size(); ++r) {
    auto const [experiment, channel, sample] = places_[r];
    auto const e = static_cast<std::size_t>(experiment);
    SimulationProgram const& program = parts_[e].residuals.program();
    double const offset = scale_offset(parts_[e].residuals.schedule().count(channel));
    for (int w = 0; w < width; ++w) {
      double value = 0;
      if (!good[static_cast<std::size_t>(w)])
        value = infinity;
      else if (sample >= 0)
        value = records[e](sample * channels + channel, w);
      else
        value = std::sqrt(2 * std::max(offset - sums[e](program.sum_row(channel, 0), w), 0.0));
      out(static_cast<int>(r), w) = std::isnan(value) ? infinity : value;
    }
  }
}

}  // namespace sysid
