// Batches of parameter vectors through the compiled kernels and programs; failures go to the ledger, never into a number.
#include "likelihood/model_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"
#include "likelihood/failures.hpp"
#include "likelihood/model_target_part.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {

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
    parts_.push_back(
        {simulator(compiled_->likelihood), simulator(compiled_->residuals), nullptr, read_by(*compiled_, *space_, e), {}, {}});
    if (options_.start_rows > 0)
      parts_.back().start =
          std::make_unique<StartState>(compiled_, experiment, options_.start_rows, options_.solver, options_.execution, pool_);
    Schedule const& schedule = parts_.back().residuals.schedule();
    first_place_.push_back(static_cast<int>(places_.size()));
    for (int c = 0; c < channels; ++c)
      for (int i = 0; i < schedule.samples(); ++i)
        if (schedule.summed(c, i)) places_.push_back({e, c, i});
    for (int c = 0; c < channels; ++c) places_.push_back({e, c, -1});
  }
  first_place_.push_back(static_cast<int>(places_.size()));
}

/// values [rows x W] of the space.
ModelTarget::Columns ModelTarget::different(ConstLanes values, int experiment) const {
  int const width = values.width();
  LaneArray all(compiled_->parameter_rows(), width);
  space_->select(values, experiment, all);
  Columns result;
  result.of_lane.resize(static_cast<std::size_t>(width));
  std::vector<int> lanes(result.of_lane.size());
  std::iota(lanes.begin(), lanes.end(), 0);
  ReadByExperiment const& read = parts_[static_cast<std::size_t>(experiment)].read;
  if (static_cast<int>(read.coordinates.size()) == dimension()) {
    result.parameters = std::move(all);
    result.example = result.of_lane = std::move(lanes);
    return result;
  }
  auto const order = [&](int a, int b) {
    for (int const r : read.parameters) {
      auto const of_a = std::bit_cast<std::uint64_t>(all(r, a)), of_b = std::bit_cast<std::uint64_t>(all(r, b));
      if (of_a != of_b) return of_a < of_b ? -1 : 1;
    }
    return 0;
  };
  std::sort(lanes.begin(), lanes.end(), [&](int a, int b) {
    int const found = order(a, b);
    return found < 0 || (found == 0 && a < b);
  });
  int first = 0;  // of those that are the same
  for (int const lane : lanes) {
    if (lane == lanes.front() || order(first, lane) != 0) first = lane;
    result.of_lane[static_cast<std::size_t>(lane)] = first;
  }
  for (int w = 0; w < width; ++w) {  // an earlier lane stands for it, and has its column
    int& of = result.of_lane[static_cast<std::size_t>(w)];
    bool const fresh = of == w;
    of = fresh ? static_cast<int>(result.example.size()) : result.of_lane[static_cast<std::size_t>(of)];
    if (fresh) result.example.push_back(w);
  }
  result.parameters = LaneArray(all.rows(), static_cast<int>(result.example.size()));
  for (int r = 0; r < all.rows(); ++r)
    for (std::size_t c = 0; c < result.example.size(); ++c) result.parameters(r, static_cast<int>(c)) = all(r, result.example[c]);
  return result;
}

std::vector<ModelTarget::Columns> ModelTarget::columns_of(std::span<ConstLanes const> theta) const {
  std::vector<Columns> columns;
  LaneArray values;
  for (int e = 0; e < static_cast<int>(parts_.size()); ++e) {
    auto const at = static_cast<std::size_t>(e);
    if (e == 0 || theta[at].data() != theta[at - 1].data()) values = space_->values(theta[at]);
    columns.push_back(different(values, e));
  }
  auto const estimate = [&](int e) {
    parts_[static_cast<std::size_t>(e)].start->estimate(columns[static_cast<std::size_t>(e)].parameters);
  };
  if (options_.start_rows == 0) return columns;
  // A single one leaves the threads to its simulations.
  if (pool_ && parts_.size() > 1)
    pool_->run(static_cast<int>(parts_.size()), estimate);
  else
    for (int e = 0; e < static_cast<int>(parts_.size()); ++e) estimate(e);
  return columns;
}

std::vector<ModelTarget::Columns> ModelTarget::columns_of(ConstLanes theta) const {
  return columns_of(std::vector<ConstLanes>(parts_.size(), theta));
}

void ModelTarget::record_failures(Simulator const& simulator, int experiment, Columns const& columns,
                                  std::span<Outcome const> outcome, ConstLanes theta, Ledger& ledger) const {
  std::string const& name = experiments_[static_cast<std::size_t>(experiment)].name;
  std::string const on_experiment = parts_.size() > 1 ? fmt::format(" on `{}`", name) : std::string();
  auto const example = [&](int column) {
    LaneArray declared(theta.rows(), 1);
    constrain(theta.columns(columns.example[static_cast<std::size_t>(column)], 1), declared);
    return std::vector<double>(declared.view().data(), declared.view().data() + declared.rows());
  };
  sysid::record_failures({simulator, columns.parameters, options_.start_rows > 0, on_experiment}, outcome, options_.describe,
                         example, ledger);
}

void ModelTarget::record_failures(bool of_residuals, std::vector<Columns> const& columns, std::vector<Run> const& runs,
                                  std::span<ConstLanes const> theta, Ledger& ledger) const {
  all_or_nothing(ledger, [&] {
    for (std::size_t e = 0; e < parts_.size(); ++e)
      record_failures(of_residuals ? parts_[e].residuals : parts_[e].likelihood, static_cast<int>(e), columns[e], runs[e].outcome,
                      theta[e], ledger);
  });
}

std::vector<ModelTarget::Run> ModelTarget::run_likelihood(std::vector<Columns> const& columns) const {
  std::vector<Run> runs(parts_.size());
  std::vector<Work> work;
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    ConstLanes const parameters = columns[e].parameters;
    runs[e].sums = LaneArray(parts_[e].likelihood.program().sum_count(), parameters.width());
    runs[e].outcome.resize(static_cast<std::size_t>(parameters.width()));
    work.push_back(parts_[e].likelihood.sums_work(parameters, runs[e].sums, runs[e].outcome));
  }
  do_work(work, pool_.get());
  return runs;
}

void ModelTarget::log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const {
  std::vector<Columns> const columns = columns_of(theta);
  std::vector<Run> const runs = run_likelihood(columns);
  record_failures(false, columns, runs, std::vector<ConstLanes>(parts_.size(), theta), ledger);
  for (std::size_t w = 0; w < out.size(); ++w) {
    double total = 0;
    bool good = true;
    for (std::size_t e = 0; e < parts_.size(); ++e) {
      int const c = columns[e].of_lane[w];
      good = good && runs[e].outcome[static_cast<std::size_t>(c)].ok;
      for (int row = 0; row < runs[e].sums.rows(); ++row) total += runs[e].sums(row, c);
    }
    out[w] = good && !std::isnan(total) ? total : -infinity;
  }
}

void ModelTarget::expect_values(double count) const {
  for (Part const& part : parts_) part.likelihood.expect(count);
}

double ModelTarget::roughness() const { return options_.roughness(compiled_->model); }

int ModelTarget::residual_count() const { return static_cast<int>(places_.size()); }

std::vector<ModelTarget::Run> ModelTarget::run_residuals(std::vector<Columns> const& columns) const {
  int const channels = static_cast<int>(compiled_->model.channels.size());
  std::vector<Run> runs(parts_.size());
  std::vector<std::vector<Outcome>> summed(parts_.size());
  std::vector<Work> work;
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    Simulator const& simulator = parts_[e].residuals;
    ConstLanes const parameters = columns[e].parameters;
    int const last = simulator.schedule().last_summed();
    runs[e].records = LaneArray(last * channels, parameters.width());
    runs[e].sums = LaneArray(simulator.program().sum_count(), parameters.width());
    runs[e].outcome.resize(static_cast<std::size_t>(parameters.width()));
    summed[e] = runs[e].outcome;
    work.push_back(simulator.records_work(parameters, 0, last, runs[e].records, runs[e].outcome));
    bool const stepped = simulator.program().registers.accumulators > 0;  // a scale that varies with the states
    work.push_back(stepped ? simulator.sums_work(parameters, runs[e].sums, summed[e])
                           : simulator.constant_sums_work(parameters, runs[e].sums, summed[e]));
  }
  do_work(work, pool_.get());
  for (std::size_t e = 0; e < parts_.size(); ++e)
    for (std::size_t c = 0; c < summed[e].size(); ++c)
      if (runs[e].outcome[c].ok && !summed[e][c].ok) runs[e].outcome[c] = summed[e][c];
  return runs;
}

double ModelTarget::residual(ResidualPlace const& place, Run const& run, int column) const {
  Simulator const& simulator = parts_[static_cast<std::size_t>(place.experiment)].residuals;
  int const channels = static_cast<int>(compiled_->model.channels.size());
  double value = 0;
  if (place.sample >= 0) {
    value = run.records(place.sample * channels + place.channel, column);
  } else {
    value =
        scale_residual(simulator.schedule().count(place.channel), run.sums(simulator.program().sum_row(place.channel, 0), column));
  }
  return std::isnan(value) ? infinity : value;
}

void ModelTarget::residuals(ConstLanes theta, Lanes out, Ledger& ledger) const {
  std::vector<Columns> const columns = columns_of(theta);
  std::vector<Run> const runs = run_residuals(columns);
  record_failures(true, columns, runs, std::vector<ConstLanes>(parts_.size(), theta), ledger);
  int const width = theta.width();
  std::vector<bool> good(static_cast<std::size_t>(width), true);
  for (std::size_t e = 0; e < parts_.size(); ++e)
    for (std::size_t w = 0; w < good.size(); ++w)
      good[w] = good[w] && runs[e].outcome[static_cast<std::size_t>(columns[e].of_lane[w])].ok;
  for (std::size_t r = 0; r < places_.size(); ++r) {
    auto const e = static_cast<std::size_t>(places_[r].experiment);
    for (int w = 0; w < width; ++w) {
      auto const lane = static_cast<std::size_t>(w);
      out(static_cast<int>(r), w) = good[lane] ? residual(places_[r], runs[e], columns[e].of_lane[lane]) : infinity;
    }
  }
}

}  // namespace sysid
