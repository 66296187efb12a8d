// Batches of parameter vectors through the compiled kernels and programs; failures go to the ledger, never into a number.
#include "likelihood/model_target.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/diagnostic.hpp"

namespace sysid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Failed solves are traced to a sub-expression by a scalar re-run, which is slow: so many per ledger, the rest are counted
// together.
constexpr std::uint64_t traced_failures = 8;
// Keeps the radicand of the scale row positive for any sensible noise level; its value does not matter, only that it is fixed.
double scale_offset(int count) { return 100.0 * count + 1000.0; }

}  // namespace

ModelTarget::ModelTarget(std::shared_ptr<CompiledModel const> compiled, Experiment experiment, TargetOptions options)
    : compiled_(std::move(compiled)),
      experiment_(std::move(experiment)),
      options_(std::move(options)),
      likelihood_(compiled_->likelihood, Schedule(*compiled_->likelihood, experiment_, options_.solver), options_.execution),
      residuals_(compiled_->residuals, Schedule(*compiled_->residuals, experiment_, options_.solver), options_.execution) {
  if (compiled_->free_start != (options_.start_rows > 0)) throw InternalError("free start without rows to estimate it from");
  if (options_.start_rows > 0)
    start_ = std::make_unique<StartState>(compiled_, experiment_, options_.start_rows, options_.solver, options_.execution);
  Model const& model = compiled_->model;
  Graph graph = model.graph;
  for (int const index : compiled_->sampled) {
    Parameter const& parameter = model.parameters[static_cast<std::size_t>(index)];
    Support const bounds = support(graph, *parameter.prior);
    auto const number = [&](std::optional<NodeId> const& bound, double fallback) {
      auto const value = bound ? graph.constant_value(*bound) : std::nullopt;
      return value ? parameter.from_si(*value) : fallback;
    };
    infos_.push_back({parameter.name, parameter.unit_text(), number(bounds.lower, -infinity), number(bounds.upper, infinity)});
  }
  Schedule const& schedule = residuals_.schedule();
  for (int c = 0; c < static_cast<int>(model.channels.size()); ++c)
    for (int i = 0; i < schedule.samples(); ++i)
      if (schedule.summed(c, i)) places_.push_back({c, i});
  for (int c = 0; c < static_cast<int>(model.channels.size()); ++c) places_.push_back({c, -1});
}

void ModelTarget::sample_prior(StreamKey key, Lanes theta) const {
  Model const& model = compiled_->model;
  LaneArray values(static_cast<int>(model.parameters.size()), theta.width());
  for (int w = 0; w < theta.width(); ++w) {
    Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
    auto const number = [&](NodeId node) {
      if (auto const constant = model.graph.constant_value(node)) return *constant;
      return model.graph.evaluate(node, [&](NodeId leaf) { return values(model.graph[leaf].index, w); });
    };
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      if (model.parameters[i].value) values(static_cast<int>(i), w) = number(*model.parameters[i].value);
    // A drawn hyperparameter may make what depends on it impossible (a negative sd): the density is zero there, so the vector is
    // drawn again, which is the joint prior.
    for (int attempt = 0;; ++attempt) {
      try {
        for (int const index : model.sampling_order) {
          Distribution const& prior = *model.parameters[static_cast<std::size_t>(index)].prior;
          std::vector<double> arguments;
          for (NodeId const argument : prior.arguments) arguments.push_back(number(argument));
          values(index, w) = draw(*prior.row, arguments, prior.lower ? number(*prior.lower) : -infinity,
                                  prior.upper ? number(*prior.upper) : infinity, stream);
        }
        break;
      } catch (UserError const&) {
        if (attempt == 1000) throw;
      }
    }
  }
  run(compiled_->unconstrain, values, theta);
}

void ModelTarget::log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const {
  LaneArray densities(2, theta.width());
  run(compiled_->prior, theta, densities);
  for (int w = 0; w < theta.width(); ++w) {
    double const value = densities(jacobian ? 0 : 1, w);
    out[static_cast<std::size_t>(w)] = std::isnan(value) ? -infinity : value;
  }
}

LaneArray ModelTarget::simulation_parameters(ConstLanes theta) const {
  LaneArray parameters(compiled_->parameter_rows(), theta.width());
  Lanes const own(parameters.view().data(), static_cast<int>(compiled_->model.parameters.size()), theta.width());
  run(compiled_->constrain, theta, own);
  if (start_) start_->estimate(parameters);
  return parameters;
}

void ModelTarget::record_failures(Simulator const& simulator, LaneArray const& parameters, std::span<Outcome const> outcome,
                                  ConstLanes theta, Ledger& ledger) const {
  ledger.add_solves(outcome.size());
  LaneArray declared;
  for (std::size_t w = 0; w < outcome.size(); ++w) {
    if (outcome[w].ok) continue;
    if (declared.rows() == 0) {
      declared = LaneArray(theta.rows(), theta.width());
      constrain(theta, declared);
    }
    std::vector<double> example;
    for (int p = 0; p < declared.rows(); ++p) example.push_back(declared(p, static_cast<int>(w)));
    if (ledger.failed() >= traced_failures) {
      ledger.add_failure(FailureClass::non_finite, "not traced", simulator.schedule().time(std::max(outcome[w].sample, 0)),
                         std::move(example));
      continue;
    }
    std::vector<double> column;
    for (int p = 0; p < parameters.rows(); ++p) column.push_back(parameters(p, static_cast<int>(w)));
    auto const found = simulator.diagnose(column);
    std::string const where = !found              ? std::string("a sum over the samples")
                              : options_.describe ? options_.describe(found->node, simulator.program().source.graph)
                                                  : std::string("the model");
    ledger.add_failure(FailureClass::non_finite, where,
                       found ? found->time : simulator.schedule().time(std::max(outcome[w].sample, 0)), std::move(example));
  }
}

void ModelTarget::log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const {
  LaneArray const parameters = simulation_parameters(theta);
  SimulationProgram const& program = likelihood_.program();
  LaneArray sums(program.sum_count(), theta.width());
  std::vector<Outcome> outcome(static_cast<std::size_t>(theta.width()));
  likelihood_.sums(parameters, sums, outcome);
  record_failures(likelihood_, parameters, outcome, theta, ledger);
  for (int w = 0; w < theta.width(); ++w) {
    double total = 0;
    for (int row = 0; row < program.sum_count(); ++row) total += sums(row, w);
    out[static_cast<std::size_t>(w)] = outcome[static_cast<std::size_t>(w)].ok && !std::isnan(total) ? total : -infinity;
  }
}

int ModelTarget::residual_count() const { return static_cast<int>(places_.size()); }

void ModelTarget::residuals(ConstLanes theta, Lanes out, Ledger& ledger) const {
  LaneArray const parameters = simulation_parameters(theta);
  SimulationProgram const& program = residuals_.program();
  Schedule const& schedule = residuals_.schedule();
  int const channels = static_cast<int>(compiled_->model.channels.size()), samples = schedule.last_summed(), width = theta.width();
  LaneArray records(samples * channels, width), sums(program.sum_count(), width);
  std::vector<Outcome> outcome(static_cast<std::size_t>(width)), summed(static_cast<std::size_t>(width));
  residuals_.records(parameters, 0, samples, records, outcome);
  residuals_.sums(parameters, sums, summed);
  for (std::size_t w = 0; w < outcome.size(); ++w)
    if (!summed[w].ok) outcome[w] = summed[w];
  record_failures(residuals_, parameters, outcome, theta, ledger);
  for (std::size_t r = 0; r < places_.size(); ++r) {
    auto const [channel, sample] = places_[r];
    for (int w = 0; w < width; ++w) {
      double value = 0;
      if (!outcome[static_cast<std::size_t>(w)].ok)
        value = infinity;
      else if (sample >= 0)
        value = records(sample * channels + channel, w);
      else
        value = std::sqrt(2 * std::max(scale_offset(schedule.count(channel)) - sums(program.sum_row(channel, 0), w), 0.0));
      out(static_cast<int>(r), w) = std::isnan(value) ? infinity : value;
    }
  }
}

void ModelTarget::constrain(ConstLanes theta, Lanes declared) const {
  Model const& model = compiled_->model;
  LaneArray all(static_cast<int>(model.parameters.size()), theta.width());
  run(compiled_->constrain, theta, all);
  for (int k = 0; k < dimension(); ++k) {
    int const index = compiled_->sampled[static_cast<std::size_t>(k)];
    for (int w = 0; w < theta.width(); ++w)
      declared(k, w) = model.parameters[static_cast<std::size_t>(index)].from_si(all(index, w));
  }
}

void ModelTarget::unconstrain(ConstLanes declared, Lanes theta) const {
  Model const& model = compiled_->model;
  LaneArray all(static_cast<int>(model.parameters.size()), declared.width());
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (model.parameters[i].value)
      for (int w = 0; w < declared.width(); ++w)
        all(static_cast<int>(i), w) = *model.graph.constant_value(*model.parameters[i].value);
  for (int k = 0; k < dimension(); ++k) {
    int const index = compiled_->sampled[static_cast<std::size_t>(k)];
    for (int w = 0; w < declared.width(); ++w)
      all(index, w) = model.parameters[static_cast<std::size_t>(index)].to_si(declared(k, w));
  }
  run(compiled_->unconstrain, all, theta);
}

}  // namespace sysid
