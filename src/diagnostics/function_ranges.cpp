// The arguments of every application, as derived quantities of a run.
#include "diagnostics/function_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/number.hpp"
#include "likelihood/compiled_model.hpp"
#include "result/visits.hpp"

namespace sysid {
namespace {

constexpr int most_examined = 100;

/// One argument of one application.
struct Argument {
  Expansion const& expansion;
  Expansion::Input const& input;
};

/// What a place reads along the runs that did not fail, SI.
struct Reading {
  std::size_t beyond = 0, samples = 0, runs_beyond = 0, runs = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(Expansion::Input const& input, std::vector<double> const& values) {
    if (std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) return;  // the run failed
    auto const outside =
        std::count_if(values.begin(), values.end(), [&](double value) { return !(value >= input.low && value <= input.high); });
    beyond += static_cast<std::size_t>(outside);
    samples += values.size();
    ++runs;
    if (outside > 0) ++runs_beyond;
    for (double const value : values) low = std::fmin(low, value), high = std::fmax(high, value);
  }
};

Finding outside(Argument const& argument, Reading const& reading, std::string const& experiment) {
  Expansion::Input const& input = argument.input;
  std::string const where = reading.runs == 1
                                ? fmt::format("at {} of {} samples of {}", reading.beyond, reading.samples, experiment)
                                : fmt::format("by {} of {} trajectories along {}", reading.runs_beyond, reading.runs, experiment);
  return {
      FindingCode::outside_range,
      Severity::warning,
      {argument.expansion.name, input.name, experiment},
      fmt::format("`{}` is evaluated outside its range {}: {} goes from {} to {}{}, `within` from {} to {}",
                  argument.expansion.name, where, input.name, significant(input.from_si(reading.low), 3),
                  significant(input.from_si(reading.high), 3), input.unit ? fmt::format(" [{}]", input.unit->text) : std::string(),
                  significant(input.from_si(input.low), 3), significant(input.from_si(input.high), 3)),
      "widen `within`: outside it the function is determined by its basis functions, not by the data"};
}

/// So many of the columns, evenly spread.
LaneArray some(ConstLanes parameters, int count) {
  LaneArray chosen(parameters.rows(), count);
  for (int w = 0; w < count; ++w) {
    int const from = static_cast<int>((2LL * w + 1) * parameters.width() / (2LL * count));
    for (int p = 0; p < parameters.rows(); ++p) chosen(p, w) = parameters(p, from);
  }
  return chosen;
}

/// What every argument of every application reads along runs.
struct Along {
  std::vector<Argument> arguments;
  std::vector<std::vector<std::vector<double>>> values;  // [arguments][runs][samples], SI
};

Along arguments_along(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                      ConstLanes parameters, ExecutionOptions const& options) {
  Along along;
  Model shown = model;
  shown.derived.clear();
  for (Expansion const& expansion : model.expansions)
    for (std::vector<NodeId> const& application : expansion.applications)
      for (std::size_t d = 0; d < application.size(); ++d) {
        Derived derived;
        derived.name = expansion.inputs[d].name;
        derived.value = application[d];
        derived.per_sample = true;
        shown.derived.push_back(std::move(derived));
        along.arguments.push_back({expansion, expansion.inputs[d]});
      }
  Trajectory const trajectory(compile(std::move(shown), start_rows > 0, solver.method), experiment, solver, start_rows, options);
  Trajectory::Result result = trajectory.run(some(parameters, std::min(parameters.width(), most_examined)), {});
  for (std::size_t q = result.values.size() - along.arguments.size(); q < result.values.size(); ++q)
    along.values.push_back(std::move(result.values[q]));
  return along;
}

}  // namespace

Findings check_ranges(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                      ConstLanes parameters, ExecutionOptions const& options) {
  if (model.expansions.empty() || parameters.width() == 0) return {};
  Along const along = arguments_along(model, experiment, solver, start_rows, parameters, options);
  Findings findings;
  for (std::size_t k = 0; k < along.arguments.size(); ++k) {
    Reading reading;
    for (std::vector<double> const& values : along.values[k]) reading.add(along.arguments[k].input, values);
    if (reading.beyond > 0) findings.push_back(outside(along.arguments[k], reading, experiment.name));
  }
  return findings;
}

void add_visits(Model const& model, Experiment const& experiment, SolverSettings const& solver, int start_rows,
                ConstLanes parameters, ExecutionOptions const& options, std::vector<FunctionReport>& functions) {
  if (model.expansions.empty() || parameters.width() == 0) return;
  Along const along = arguments_along(model, experiment, solver, start_rows, parameters, options);
  for (std::size_t k = 0; k < along.arguments.size(); ++k) {
    auto const& [expansion, input] = along.arguments[k];
    FunctionReport& function = functions[static_cast<std::size_t>(&expansion - model.expansions.data())];
    std::vector<double>& visits = function.visits[static_cast<std::size_t>(&input - expansion.inputs.data())];
    for (std::vector<double> const& values : along.values[k])
      for (std::size_t i = 0; i < values.size(); ++i)
        if (experiment.scored[i] != 0) count_visit(visits, (values[i] - input.low) / (input.high - input.low));
  }
}

}  // namespace sysid
