// Conditional distributions at the places of a record, all at once or sample by sample.
#include "likelihood/process/process_forecast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "gaussian_process/concern.hpp"
#include "gaussian_process/dense.hpp"
#include "gaussian_process/regression.hpp"
#include "model/lags.hpp"

namespace sysid {
namespace {

using gaussian_process::DensePosterior;

using gaussian_process::Places;
using gaussian_process::Prediction;

std::vector<int> all_of(int samples) {
  std::vector<int> rows(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i) rows[static_cast<std::size_t>(i)] = i;
  return rows;
}

}  // namespace

/// One sample after the other: states, data and processes go into kernels as rows of lanes.
struct ProcessForecast::FreeRun {
  struct Input {
    enum class Kind { parameter, state, data, process } kind;
    int index;         // of a parameter, a state, a process
    UniformLeaf leaf;  // of data
  };
  std::vector<Input> inputs;
  Kernel initial, arguments, outcome;    // states; inputs of all processes; centres, parametric parts and next states
  std::vector<int> argument_of_process;  // first argument of each process
  int processes = 0, all_arguments = 0;

  FreeRun(Model const& model) {
    Graph graph = model.graph;
    auto const folded = [&](NodeId root) {
      return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph[leaf];
        if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
        return model.parameters[static_cast<std::size_t>(node.index)].value_of_all();
      });
    };
    std::vector<NodeId> starts, places, results;
    for (State const& state : model.states) starts.push_back(folded(state.initial));
    processes = static_cast<int>(model.processes.size());
    for (Process const& process : model.processes) {
      argument_of_process.push_back(static_cast<int>(places.size()));
      for (NodeId const argument : process.arguments) places.push_back(folded(argument));
    }
    all_arguments = static_cast<int>(places.size());
    for (Channel const& channel : model.channels) results.push_back(folded(channel.noise.arguments[0]));
    for (Channel const& channel : model.channels) results.push_back(folded(without_processes(graph, channel.noise.arguments[0])));
    for (State const& state : model.states) results.push_back(folded(state.derivative));
    std::vector<NodeId> roots = starts, leaves;
    roots.insert(roots.end(), places.begin(), places.end());
    roots.insert(roots.end(), results.begin(), results.end());
    for (NodeId const id : graph.reachable(roots)) {
      Node const node = graph[id];
      if (node.operation != Operation::leaf) continue;
      leaves.push_back(id);
      using Kind = Input::Kind;
      Kind const kind = node.leaf_kind == LeafKind::parameter ? Kind::parameter
                        : node.leaf_kind == LeafKind::state   ? Kind::state
                        : node.leaf_kind == LeafKind::process ? Kind::process
                                                              : Kind::data;
      inputs.push_back({kind, node.index, {node.leaf_kind, node.index, node.stage, node.lag}});
    }
    initial = compile_kernel(graph, leaves, starts);
    arguments = compile_kernel(graph, leaves, places);
    outcome = compile_kernel(graph, leaves, results);
  }

  /// The kernels' inputs at a sample.
  LaneArray at(ConstLanes own, ConstLanes states, ConstLanes drawn, Schedule const& schedule, int sample) const {
    LaneArray rows(static_cast<int>(inputs.size()), states.width());
    for (int r = 0; r < rows.rows(); ++r) {
      Input const& input = inputs[static_cast<std::size_t>(r)];
      for (int w = 0; w < rows.width(); ++w)
        rows(r, w) = input.kind == Input::Kind::parameter ? own(input.index, 0)
                     : input.kind == Input::Kind::state   ? states(input.index, w)
                     : input.kind == Input::Kind::process ? drawn(input.index, w)
                                                          : schedule.at_sample(input.leaf, sample);
    }
    return rows;
  }
};

ProcessForecast::ProcessForecast(std::shared_ptr<ProcessTarget const> trained, std::shared_ptr<ProcessModel const> model,
                                 Experiment const& experiment, SolverSettings const& solver, int start_rows,
                                 ExecutionOptions const& options)
    : trained_(std::move(trained)), model_(std::move(model)), record_(model_, experiment, solver, start_rows, options) {
  if (feeds_back(model_->model())) free_run_ = std::make_shared<FreeRun const>(model_->model());
  std::vector<Channel> const& channels = model_->model().channels;
  for (std::size_t c = 0; c < channels.size(); ++c)
    quantities_.push_back({channels[c].name, channels[c].unit_of_numbers(), static_cast<int>(c)});
  for (Channel const& channel : channels)
    quantities_.push_back({fmt::format("white({})", channel.name), channel.unit_of_numbers(), -1});
}

bool ProcessForecast::at_once(std::vector<ProcessTarget::Regression> const& fitted, ConstLanes own, int count, StreamKey key,
                              std::uint64_t first, Paths& values, Paths& noisy, Paths& parametric) const {
  ProcessRecord::Records const records = record_.run(own);
  if (!records.outcome.front().ok) return false;
  std::vector<int> const rows = all_of(record_.samples());
  for (std::size_t c = 0; c < fitted.size(); ++c) {
    ProcessRows const here = record_.rows(records, static_cast<int>(c), 0, rows);
    // A sample whose inputs or parametric part have no value is predicted by nothing; the others are as they are without it.
    std::vector<Eigen::Index> predicted;
    for (Eigen::Index i = 0; i < here.parametric.size(); ++i)
      if (here.inputs.row(i).allFinite() && std::isfinite(here.parametric[i])) predicted.push_back(i);
    if (predicted.empty()) return false;
    auto const& covariance = model_->channels()[c].covariance;
    auto const count_of_places = static_cast<Eigen::Index>(predicted.size());
    Places const places{here.inputs(predicted, Eigen::all), Eigen::MatrixXd(count_of_places, 0)};
    auto const conditional = gaussian_process::conditional(covariance, fitted[c].observations, fitted[c].parameters, places);
    if (conditional.outcome != gaussian_process::Outcome::fine) return false;
    Prediction const& prediction = conditional.prediction;
    double const sd = fitted[c].parameters.back();
    for (int d = 0; d < count; ++d) {
      Stream stream(key.at(key.index + first + static_cast<std::uint64_t>(d), c));
      for (Eigen::Index i = 0; i < count_of_places; ++i) {
        Eigen::Index const sample = predicted[static_cast<std::size_t>(i)];
        auto const k = static_cast<std::size_t>(sample);
        double const value = here.parametric[sample] + prediction.mean[i] + std::sqrt(prediction.variance[i]) * stream.normal();
        values[c][static_cast<std::size_t>(d)][k] = value;
        noisy[c][static_cast<std::size_t>(d)][k] = value + sd * stream.normal();
      }
      std::copy(here.parametric.begin(), here.parametric.end(), parametric[c][static_cast<std::size_t>(d)].begin());
    }
  }
  return true;
}

bool ProcessForecast::sample_by_sample(std::vector<ProcessTarget::Regression> const& fitted, ConstLanes own, int count,
                                       StreamKey key, std::uint64_t first, Paths& values, Paths& noisy, Paths& parametric) const {
  std::size_t const channels = fitted.size();
  std::vector<DensePosterior> posteriors;
  for (std::size_t c = 0; c < channels; ++c) {
    posteriors.emplace_back(model_->channels()[c].covariance, fitted[c].observations, fitted[c].parameters);
    if (posteriors.back().outcome() != gaussian_process::Outcome::fine) return false;
  }
  FreeRun const& run = *free_run_;
  Schedule const& schedule = record_.simulator().schedule();
  int const states = static_cast<int>(model_->model().states.size());
  LaneArray state(states, count), drawn(run.processes, count), places(run.all_arguments, count);
  LaneArray outcome(2 * static_cast<int>(channels) + states, count);
  std::vector<Stream> streams;
  for (int d = 0; d < count; ++d) streams.emplace_back(key.at(key.index + first + static_cast<std::uint64_t>(d), 0));
  sysid::run(run.initial, run.at(own, state, drawn, schedule, 0), state);
  for (int i = 0; i < record_.samples(); ++i) {
    sysid::run(run.arguments, run.at(own, state, drawn, schedule, i), places);
    for (int p = 0; p < run.processes; ++p)
      for (int d = 0; d < count; ++d) drawn(p, d) = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      // All processes of a channel are drawn as their sum, which its first one stands for.
      int column = 0, leading = -1;
      Eigen::MatrixXd at(count, static_cast<Eigen::Index>(model_->channels()[c].arguments.size()));
      for (int p = 0; p < run.processes; ++p) {
        Process const& process = model_->model().processes[static_cast<std::size_t>(p)];
        if (process.channel != static_cast<int>(c)) continue;
        if (leading < 0) leading = p;
        for (int a = 0; a < static_cast<int>(process.arguments.size()); ++a, ++column)
          for (int d = 0; d < count; ++d) at(d, column) = places(run.argument_of_process[static_cast<std::size_t>(p)] + a, d);
      }
      if (!at.allFinite()) return false;
      Prediction const prediction = posteriors[c].predict({at, Eigen::MatrixXd(count, 0)});
      for (int d = 0; d < count; ++d)
        drawn(leading, d) = prediction.mean[d] + std::sqrt(prediction.variance[d]) * streams[static_cast<std::size_t>(d)].normal();
    }
    sysid::run(run.outcome, run.at(own, state, drawn, schedule, i), outcome);
    for (std::size_t c = 0; c < channels; ++c)
      for (int d = 0; d < count; ++d) {
        auto const k = static_cast<std::size_t>(d);
        double const value = outcome(static_cast<int>(c), d);
        values[c][k][static_cast<std::size_t>(i)] = value;
        noisy[c][k][static_cast<std::size_t>(i)] = value + fitted[c].parameters.back() * streams[k].normal();
        parametric[c][k][static_cast<std::size_t>(i)] = outcome(static_cast<int>(channels + c), d);
      }
    for (int s = 0; s < states; ++s)
      for (int d = 0; d < count; ++d) state(s, d) = outcome(2 * static_cast<int>(channels) + s, d);
  }
  return true;
}

void ProcessForecast::run(ConstLanes fitted, ConstLanes own, int count, StreamKey key, std::uint64_t first,
                          Trajectory::Result& result) const {
  std::vector<Channel> const& channels = model_->model().channels;
  std::size_t const samples = static_cast<std::size_t>(record_.samples());
  std::vector<double> const none(samples, std::nan(""));
  Paths values(channels.size(), {static_cast<std::size_t>(count), none}), noisy = values, parametric = values;
  std::vector<ProcessTarget::Regression> regressions;
  for (int c = 0; c < static_cast<int>(channels.size()); ++c)
    if (auto regression = trained_->regression(fitted, c, false)) regressions.push_back(std::move(*regression));
  bool good = regressions.size() == channels.size();
  if (good && !free_run_) {
    good = at_once(regressions, own, count, key, first, values, noisy, parametric);
  } else if (good) {
    good = sample_by_sample(regressions, own, count, key, first, values, noisy, parametric);
  }
  result.values.resize(quantities_.size());
  result.noisy.resize(channels.size());
  result.ledger.add_solves(static_cast<std::uint64_t>(count));
  if (!good)
    result.ledger.add_failure(FailureClass::non_finite, "the Gaussian process", std::nan(""), {},
                              static_cast<std::uint64_t>(count));
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (std::size_t d = 0; d < static_cast<std::size_t>(count); ++d) {
      auto const declared = [&](std::vector<double> path) {
        for (double& value : path) value = good ? channels[c].from_si(value) : std::nan("");
        return path;
      };
      result.values[c].push_back(declared(std::move(values[c][d])));
      result.values[channels.size() + c].push_back(declared(std::move(parametric[c][d])));
      result.noisy[c].push_back(declared(std::move(noisy[c][d])));
    }
}

std::vector<ProcessForecast::Reach> ProcessForecast::reach(ConstLanes fitted, ConstLanes own) const {
  std::vector<Reach> result;
  if (free_run_) return result;  // where a free run goes is not known before
  ProcessRecord::Records const records = record_.run(own);
  if (!records.outcome.front().ok) return result;
  std::vector<int> rows;
  for (int i = 0; i < record_.samples(); ++i)
    if (record_.experiment().scored[static_cast<std::size_t>(i)] != 0) rows.push_back(i);
  for (int c = 0; c < static_cast<int>(model_->channels().size()); ++c) {
    auto const regression = trained_->regression(fitted, c, false);
    if (!regression) continue;
    ProcessRows const here = record_.rows(records, c, 0, rows);
    std::vector<Eigen::Index> known;
    for (Eigen::Index i = 0; i < here.inputs.rows(); ++i)
      if (here.inputs.row(i).allFinite()) known.push_back(i);
    Eigen::MatrixXd const inputs = here.inputs(known, Eigen::all);
    int column = 0;
    for (Process const& process : model_->model().processes) {
      if (process.channel != c) continue;
      for (Quantity const& input : process.inputs) {
        for (auto const& concern : gaussian_process::places_outside(regression->observations.inputs, inputs, {column})) {
          bool const again = !result.empty() && result.back().process == process.name && result.back().input == input.name;
          if (!again) result.push_back({process.name, input.name, 0});  // of several lags the farthest
          result.back().widths = std::max(result.back().widths, concern.value);
        }
        ++column;
      }
    }
  }
  return result;
}

}  // namespace sysid
