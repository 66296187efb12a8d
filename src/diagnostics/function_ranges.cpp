// The arguments of every application, as derived quantities of a run.
#include "diagnostics/function_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/statistics.hpp"
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

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void include(Extent const& other) { low = std::fmin(low, other.low), high = std::fmax(high, other.high); }
};

// From where to where an argument goes in the scored rows, in the median of the runs that did not fail.
Extent middle_extent(std::vector<std::vector<double>> const& values, Experiment const& experiment) {
  std::vector<double> lows, highs;
  for (std::vector<double> const& run : values) {
    Extent extent;
    for (std::size_t i = 0; i < run.size(); ++i)
      if (experiment.scored[i] != 0 && !std::isnan(run[i])) extent.include({run[i], run[i]});
    if (!(extent.low <= extent.high)) continue;
    lows.push_back(extent.low);
    highs.push_back(extent.high);
  }
  return lows.empty() ? Extent() : Extent{median(lows), median(highs)};
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

Findings check_reach(Model const& model, std::vector<RunsAlong> const& fitted, RunsAlong const& predicted,
                     SolverSettings const& solver, ExecutionOptions const& options) {
  constexpr double tolerated = 0.1;
  constexpr int runs = 20;
  if (model.expansions.empty() || fitted.empty() || predicted.parameters.width() == 0) return {};
  auto const along = [&](RunsAlong const& each) {
    return arguments_along(model, each.experiment, solver, each.start_rows,
                           some(each.parameters, std::min(each.parameters.width(), runs)), options);
  };
  std::vector<Along> seen;
  for (RunsAlong const& each : fitted) seen.push_back(along(each));
  Along const there = along(predicted);
  Findings findings;
  for (std::size_t k = 0; k < there.arguments.size(); ++k) {
    auto const& [expansion, input] = there.arguments[k];
    // What the fit has seen of this input, by whichever application.
    Extent visited;
    for (std::size_t e = 0; e < seen.size(); ++e)
      for (std::size_t other = 0; other < seen[e].arguments.size(); ++other)
        if (&seen[e].arguments[other].input == &input) visited.include(middle_extent(seen[e].values[other], fitted[e].experiment));
    Extent const reached = middle_extent(there.values[k], predicted.experiment);
    double const width = visited.high - visited.low, beyond = std::max(reached.high - visited.high, visited.low - reached.low);
    bool const inside = reached.low >= input.low && reached.high <= input.high;
    bool const told = std::any_of(findings.begin(), findings.end(), [&expansion = expansion, &input = input](Finding const& each) {
      return each.names.front() == expansion.name && each.names[1] == input.name;
    });
    if (!inside || told || !(beyond > tolerated * width)) continue;
    findings.push_back(
        {FindingCode::far_outside,
         Severity::warning,
         {expansion.name, input.name, predicted.experiment.name},
         fmt::format("`{}` is evaluated far from the fitted data along {}: {} goes from {} to {}{}, in the fitted rows "
                     "from {} to {}",
                     expansion.name, predicted.experiment.name, input.name, significant(input.from_si(reached.low), 3),
                     significant(input.from_si(reached.high), 3),
                     input.unit ? fmt::format(" [{}]", input.unit->text) : std::string(),
                     significant(input.from_si(visited.low), 3), significant(input.from_si(visited.high), 3)),
         "there the values and the band follow from the prior of the function, not from data: fit a record that covers this "
         "range"});
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
