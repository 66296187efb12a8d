// Trajectories of the fit as it is written, at draws of either fit.
#include "app/disturbed/explained_share.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <variant>
#include <vector>

#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/stored_draws.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

/// Nothing where the channel does not change. Predicted in declared units, as `channel` is measured.
std::optional<double> share_of(Experiment const& experiment, Channel const& channel, std::size_t c,
                               std::vector<double> const& predicted) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    if (experiment.is_scored(c, i)) {
      sum += channel.from_si(experiment.measured[c][i]);
      ++count;
    }
  double left = 0, all = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    if (experiment.is_scored(c, i)) {
      double const measured = channel.from_si(experiment.measured[c][i]);
      left += std::pow(measured - predicted[i], 2);
      all += std::pow(measured - sum / count, 2);
    }
  if (!(all > 0)) return std::nullopt;
  return std::isfinite(left) ? std::max(0.0, 1 - left / all) : std::nan("");
}

/// Sums over channels, per draw.
struct SharesOfDraws {
  std::vector<double> sum;
  int channels = 0;
};

void add_experiment(Trajectory const& trajectory, Trajectory::Result const& result, Model const& model,
                    Experiment const& experiment, SharesOfDraws& shares) {
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    int const channel = trajectory.quantities()[q].channel;
    if (channel < 0) continue;
    auto const c = static_cast<std::size_t>(channel);
    if (experiment.measured[c].empty()) continue;
    bool changes = false;
    for (std::size_t draw = 0; draw < shares.sum.size(); ++draw)
      if (auto const share = share_of(experiment, model.channels[c], c, result.values[q][draw])) {
        shares.sum[draw] += *share;
        changes = true;
      }
    shares.channels += changes;
  }
}

}  // namespace

std::optional<double> explained_share(Session& like, Task const& fit, std::filesystem::path const& results) {
  constexpr int most_draws = 9;
  std::ostream silent(nullptr);
  Session session(like.source, like.file, like.options, like.progress, silent, silent);
  FitTask const& what = std::get<FitTask>(fit.what);
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  auto const space = parameter_space(model, what.experiments);
  std::vector<std::string> names;
  for (ParameterInfo const& each : space->infos()) names.push_back(each.name);
  FittedModel const fitted = read_fitted(results, names);
  // The solver of the fit as it is written: that of random states need not suit.
  SolverSettings const solver = read_fitted(like.result_folder(fit), names).solver;
  auto const compiled = session.compiled(what, solver.method);
  if (compiled->model.filtered()) return std::nullopt;  // errors of inputs: samples correct what is predicted
  LaneArray const values = space->values_of_declared(spread(fitted.draws, most_draws));
  SharesOfDraws shares{std::vector<double>(static_cast<std::size_t>(values.width()), 0.0)};
  std::vector<ExperimentData> const data = load_experiments(session, what.experiments, model, what.start, what.prediction, solver);
  for (std::size_t e = 0; e < data.size(); ++e) {
    Trajectory const trajectory(compiled, data[e].experiment, solver, start_rows(what.start), session.abandonable());
    LaneArray parameters(static_cast<int>(model.parameters.size()), values.width());
    space->select(values, static_cast<int>(e), parameters);
    add_experiment(trajectory, trajectory.run(parameters, {1, Purpose::prediction}), model, data[e].experiment, shares);
  }
  std::erase_if(shares.sum, [](double sum) { return !std::isfinite(sum); });
  if (shares.channels == 0 || 2 * shares.sum.size() < static_cast<std::size_t>(values.width())) return std::nullopt;
  std::sort(shares.sum.begin(), shares.sum.end());
  return shares.sum[shares.sum.size() / 2] / shares.channels;
}

bool ExplainedShares::replaced() const {
  // A force that was not measured is no part of what the equations explain: with its size estimated they explain nearly as much as
  // the best fit without it. Of a record that they hardly explain, there is nothing to be replaced.
  constexpr double little = 0.1, kept = 0.5;
  return without && with && *without > little && *with < kept * *without;
}

}  // namespace sysid
