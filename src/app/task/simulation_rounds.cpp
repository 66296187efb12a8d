// Rounds: each run reads what the one before has made, until nothing changes.
#include "app/task/simulation_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/fourier.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr double doubles = sizeof(double), characters = 2 * 22;  // of a number; of its text, which grows by doubling

}  // namespace

double bytes_to_simulate(SimulateTask const& what, CompiledModel const& compiled) {
  auto const samples = static_cast<double>(what.samples);
  auto const records = static_cast<double>(compiled.records.size()), inputs = static_cast<double>(compiled.model.inputs.size());
  auto const columns = static_cast<double>(what.inputs.size() + 2 * compiled.model.channels.size() + 1);
  double most = 0;  // of the inputs, which are made one after the other
  for (InputGenerator const& each : what.inputs)
    if (each.kind == InputGenerator::Kind::multisine)
      most = std::max(most, bytes_to_add_harmonics(static_cast<std::size_t>(what.samples)));
  return most + samples * (doubles * (4 + 8 * inputs + 4 * records + columns) + characters * columns);
}

Feedback measured_samples(CompiledModel const& compiled) {
  return [&compiled](Trajectory::Result const& run, Experiment& experiment) {
    std::vector<std::vector<double>> const before = experiment.measured;
    for (std::size_t c = 0; c < before.size(); ++c)
      for (std::size_t i = 0; i < before[c].size(); ++i) {
        double const made = compiled.model.channels[c].to_si(run.noisy[c][0][i]);
        if (std::isfinite(made)) experiment.measured[c][i] = made;
      }
    return experiment.measured != before;
  };
}

// Processes are the last inputs; before the record they are zero, as all inputs are. Their values may differ by rounding from round
// to round, since jitter is a share of the mean variance.
Feedback drawn_values(DrawnFunctions const& functions, std::vector<double> const& time, int history) {
  return [&functions, &time, history, before = std::vector<std::vector<double>>()](Trajectory::Result const& run,
                                                                                   Experiment& experiment) mutable {
    std::vector<std::vector<double>> now = functions.along(run);
    std::size_t const first = experiment.inputs.size() - now.size();
    double change = 0, size = 0;
    for (std::size_t p = 0; p < now.size(); ++p)
      for (std::size_t i = 0; i < now[p].size(); ++i) {
        change = std::max(change, std::fabs(now[p][i] - (before.empty() ? 0 : before[p][i])));
        size = std::max(size, std::fabs(now[p][i]));
      }
    for (std::size_t p = 0; p < now.size(); ++p) {
      std::vector<double> samples(static_cast<std::size_t>(history), 0.0);
      samples.insert(samples.end(), now[p].begin(), now[p].end());
      experiment.inputs[first + p] =
          InputSignal(InputRule::zero_order, time, std::move(samples)).view(history, static_cast<int>(now[p].size()));
    }
    before = std::move(now);
    return change > 1e-9 * size;
  };
}

// As many rounds as there are feedbacks make at least one more sample right, the draws being the same, so that this would end, were
// it not for rounding, which a chaotic model blows up; a stable model takes few. Nothing: interrupted.
std::optional<Trajectory::Result> in_rounds(Session& session, Task const& task,
                                            std::shared_ptr<CompiledModel const> const& compiled, Experiment& experiment,
                                            SimulateTask const& what, LaneArray const& parameters, StreamKey noise_key,
                                            std::vector<Feedback>& feedbacks) {
  auto const most = static_cast<std::size_t>(what.samples) * feedbacks.size() + 1;
  for (std::size_t round = 0; round <= most; ++round) {
    Trajectory const trajectory(compiled, experiment, what.solver, 0, session.abandonable());
    Trajectory::Result result = trajectory.run(parameters, noise_key);
    if (session.interrupted()) return std::nullopt;
    if (result.failed() > 0) return result;
    bool changed = false;
    for (Feedback& feedback : feedbacks) changed = feedback(result, experiment) || changed;
    if (!changed) return result;
  }
  throw UserError({Severity::error,
                   "E5001",
                   fmt::format("the simulation `{}` does not converge: the model uses its own output as input, so the record is "
                               "computed again and again until it no longer changes, but it keeps changing",
                               task.name),
                   Label{task.span, {}},
                   {},
                   "the model may be chaotic, so that rounding errors grow: use fewer samples, or other values of the parameters"});
}

}  // namespace sysid
