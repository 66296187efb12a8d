// Gauss-Newton for initial states, many parameter vectors at once: each round is one batch of states + 1 short simulations per
// parameter vector that is still at work.
#include "likelihood/start_state.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/not_finite.hpp"
#include "core/text/diagnostic.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

// A perturbation should move the outputs by this fraction of their size: small against curvature, large against rounding. To begin
// with, one serves that moves them by at most 100 times as much, and at least 1/10,000 with steps of equal length, whose outputs
// are smooth to rounding, or 1/100 with others.
constexpr double relative_effect = 1e-4;
constexpr double least_first_effect = 1e-4, least_of_rough = 1e-2, most_first_effect = 100;
constexpr int most_start_probes = 12;
constexpr int least_moves = 2, most_rounds = 40;

// What a move does to the outputs, in units of their misfit, which is the move in standard deviations of the start. Below the first
// it is the last one; above the second, a tenth as in the tolerance guard, no start was found: steps of adaptive solvers make
// slopes rough to a hundredth. The other part is for records that a model meets exactly, in units of the outputs.
double is_converged(double misfit, double size) { return 1e-6 * misfit + 1e-10 * size; }
double doubtful(double misfit, double size) { return 0.1 * misfit + 1e-6 * size; }

Experiment window_of(Experiment const& experiment, int rows) {
  Experiment window = experiment;
  auto const n = static_cast<std::size_t>(rows);
  window.time.resize(n);
  for (auto& channel : window.measured)
    if (!channel.empty()) channel.resize(n);
  window.scored.assign(n, 1);
  return window;
}

/// The standard deviation of the samples that are there; 0 where they are all the same, whatever rounding makes of their mean.
double spread_of_samples(std::span<double const> samples) {
  double sum = 0, square = 0;
  double least = infinity, most = -infinity;
  int n = 0;
  for (double const y : samples)
    if (!std::isnan(y)) sum += y, ++n, least = std::min(least, y), most = std::max(most, y);
  if (!(least < most)) return 0;
  for (double const y : samples)
    if (!std::isnan(y)) square += (y - sum / n) * (y - sum / n);
  return std::sqrt(square / n);
}

/// What a channel is measured in: how much it moves in the window. A record that begins at rest says so only further on.
double unit_of_channel(std::span<double const> whole, std::size_t rows) {
  std::span<double const> const window = whole.first(rows);
  if (double const sd = spread_of_samples(window); sd > 0) return sd;
  if (double const sd = spread_of_samples(whole); sd > 0) return sd;
  for (double const y : window)
    if (!std::isnan(y) && y != 0) return std::abs(y);
  return 1;
}

int clamp_rows(Experiment const& experiment, int rows) { return std::min(rows, static_cast<int>(experiment.time.size())); }

}  // namespace

StartState::StartState(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, int rows,
                       SolverSettings const& solver, ExecutionOptions options, std::shared_ptr<ThreadPool> pool)
    : compiled_(std::move(compiled)),
      rows_(clamp_rows(experiment, rows)),
      least_effect_(solver.fixed_step() ? least_first_effect : least_of_rough),
      simulator_(compiled_->trajectory,
                 Schedule(*compiled_->trajectory, window_of(experiment, clamp_rows(experiment, rows)), solver), options,
                 std::move(pool)) {
  for (std::size_t r = 0; r < compiled_->records.size(); ++r) {
    auto const& record = compiled_->records[r];
    if (record.kind != CompiledModel::Record::Kind::centre) continue;
    auto const& channel = experiment.measured[static_cast<std::size_t>(record.index)];
    if (channel.empty()) continue;
    std::vector<double> samples(channel.begin(), channel.begin() + rows_);
    auto const n = std::ranges::count_if(samples, [](double y) { return !std::isnan(y); });
    if (n == 0) continue;
    record_.push_back(static_cast<int>(r));
    weights_.push_back(1 / unit_of_channel(channel, samples.size()));
    samples_.push_back(std::move(samples));
    count_ += rows_;
    data_norm_ += static_cast<double>(n);
  }
  data_norm_ = std::sqrt(data_norm_);
}

void StartState::residuals(ConstLanes parameters, LaneArray& out) const {
  int const width = parameters.width(), records = static_cast<int>(compiled_->records.size());
  LaneArray all(rows_ * records, width);
  std::vector<Outcome> outcome(static_cast<std::size_t>(width));
  simulator_.records(parameters, 0, rows_, all, outcome);
  out = LaneArray(count_, width);
  int row = 0;
  for (std::size_t c = 0; c < record_.size(); ++c)
    for (int i = 0; i < rows_; ++i, ++row) {
      double const y = samples_[c][static_cast<std::size_t>(i)];
      if (std::isnan(y)) continue;  // the row stays zero
      for (int w = 0; w < width; ++w) out(row, w) = weights_[c] * (all(i * records + record_[c], w) - y);
    }
}

/// The iteration of one parameter vector.
struct StartState::Search {
  int lane = 0;
  Eigen::VectorXd step;   // perturbation of each state; 0: nothing that the window shows
  Eigen::VectorXd state;  // the best so far
  Eigen::VectorXd move;   // on trial: state - move
  double cost = std::numeric_limits<double>::infinity();
  double predicted = 0;  // what the whole move does to the outputs, to first order
  int moves = 0;
  bool done = false;
};

void StartState::differences(ConstLanes parameters, std::span<Search* const> searches, std::vector<Slopes>& out) const {
  int const states = static_cast<int>(compiled_->model.states.size()), first = parameters.rows() - states;
  LaneArray batch(parameters.rows(), static_cast<int>(searches.size()) * (states + 1)), residual;
  int column = 0;
  for (Search const* search : searches)
    for (int k = 0; k <= states; ++k, ++column) {
      for (int r = 0; r < parameters.rows(); ++r) batch(r, column) = parameters(r, search->lane);
      for (int s = 0; s < states; ++s)
        batch(first + s, column) = search->state(s) - search->move(s) + (k == s + 1 ? search->step(s) : 0.0);
    }
  residuals(batch, residual);
  out.assign(searches.size(), {Eigen::VectorXd(count_), Eigen::MatrixXd(count_, states)});
  column = 0;
  for (Slopes& slopes : out) {
    for (int i = 0; i < count_; ++i) {
      slopes.residual(i) = residual(i, column);
      for (int s = 0; s < states; ++s) slopes.change(i, s) = residual(i, column + 1 + s) - residual(i, column);
    }
    column += states + 1;
  }
}

void StartState::find_steps(ConstLanes parameters, std::span<Search> searches) const {
  int const states = static_cast<int>(compiled_->model.states.size());
  std::vector<Slopes> slopes;
  std::vector<Eigen::Array<bool, Eigen::Dynamic, 1>> good(searches.size());
  for (auto& each : good) each.setConstant(states, false);
  for (int probe = 0; probe < most_start_probes; ++probe) {
    std::vector<Search*> open;
    for (std::size_t k = 0; k < searches.size(); ++k)
      if (!searches[k].done && !good[k].all()) open.push_back(&searches[k]);
    if (open.empty()) return;
    differences(parameters, open, slopes);
    for (std::size_t k = 0; k < open.size(); ++k) {
      Search& search = *open[k];
      auto& known = good[static_cast<std::size_t>(&search - searches.data())];
      search.done = !slopes[k].residual.allFinite();  // it fails in the simulation that follows, and is counted there
      for (int s = 0; s < states; ++s) {
        double const effect = slopes[k].change.col(s).norm() / (relative_effect * data_norm_);
        known(s) = known(s) || (effect >= least_effect_ && effect <= most_first_effect);
        if (known(s)) continue;
        search.step(s) *= !std::isfinite(effect) ? 1e-4 : std::clamp(effect > 0 ? 1 / effect : 1e6, 1e-6, 1e6);
      }
      if (!search.done && known.all()) advance(search, slopes[k]);
    }
  }
  for (std::size_t k = 0; k < searches.size(); ++k)
    for (int s = 0; s < states; ++s)
      if (!good[k](s)) searches[k].step(s) = 0;
}

void StartState::advance(Search& search, Slopes const& slopes) const {
  double const cost = slopes.residual.squaredNorm();
  if (!(cost <= search.cost * (1 + 1e-9))) {  // not finite, or worse: a part of the move
    search.move /= 2;
    return;
  }
  Eigen::MatrixXd scaled = slopes.change;
  Eigen::VectorXd effect(search.step.size());
  for (Eigen::Index s = 0; s < effect.size(); ++s) {
    double const moved = scaled.col(s).norm();
    if (!std::isfinite(moved)) {  // the same place again
      search.step(s) *= 1e-2;
      return;
    }
    if (moved > 0) scaled.col(s) /= moved;
    effect(s) = moved > 0 ? moved / search.step(s) : 0;
    if (moved > 0) search.step(s) = relative_effect * data_norm_ / effect(s);
  }
  search.state -= search.move;
  search.cost = cost;
  ++search.moves;
  Eigen::MatrixXd normal = scaled.transpose() * scaled;
  for (Eigen::Index s = 0; s < effect.size(); ++s) normal(s, s) += effect(s) > 0 ? 1e-10 : 1.0;
  Eigen::VectorXd const solved = solve_symmetric(normal, scaled.transpose() * slopes.residual);
  search.predicted = (scaled * solved).norm();
  for (Eigen::Index s = 0; s < effect.size(); ++s) search.move(s) = effect(s) > 0 ? solved(s) / effect(s) : 0;
  double const misfit = std::sqrt(cost) / data_norm_;
  if (search.moves <= least_moves || !(search.predicted <= is_converged(misfit, data_norm_))) return;
  search.state -= search.move;
  search.done = true;
}

void StartState::estimate(Lanes parameters) const {
  int const width = parameters.width(), states = static_cast<int>(compiled_->model.states.size());
  int const first = parameters.rows() - states;
  if (parameters.rows() != compiled_->parameter_rows()) throw InternalError("a start is estimated among other rows of parameters");
  {
    // The kernel reads the model's parameters only.
    ConstLanes const own(parameters.data(), first, width, parameters.stride());
    Lanes const start(parameters.data() + static_cast<std::ptrdiff_t>(first) * parameters.stride(), states, width,
                      parameters.stride());
    run(compiled_->initial, own, start);
  }
  if (count_ == 0) return;
  std::vector<Search> searches(static_cast<std::size_t>(width));
  for (int w = 0; w < width; ++w) {
    Search& search = searches[static_cast<std::size_t>(w)];
    search.lane = w;
    search.state = search.step = search.move = Eigen::VectorXd::Zero(states);
    for (int s = 0; s < states; ++s) {
      search.state(s) = parameters(first + s, w);
      search.step(s) = search.state(s) != 0 ? relative_effect * std::abs(search.state(s)) : 1e-6;
    }
  }
  find_steps(parameters, searches);
  std::vector<bool> tried(searches.size());
  for (std::size_t k = 0; k < searches.size(); ++k) tried[k] = !searches[k].done;
  std::vector<Slopes> slopes;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<Search*> open;
    for (Search& search : searches)
      if (!search.done) open.push_back(&search);
    if (open.empty()) break;
    differences(parameters, open, slopes);
    for (std::size_t k = 0; k < open.size(); ++k) advance(*open[k], slopes[k]);
  }
  for (std::size_t k = 0; k < searches.size(); ++k) {
    Search const& search = searches[k];
    if (!tried[k]) continue;
    double const misfit = std::sqrt(search.cost) / data_norm_;
    bool const found = search.moves > 0 && search.predicted <= doubtful(misfit, data_norm_);
    for (int s = 0; s < states; ++s)
      parameters(first + s, search.lane) = found ? search.state(s) : std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace sysid
