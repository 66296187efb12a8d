// Gauss-Newton for initial states, many parameter vectors at once: each iteration is one batch of (states + 1) W short simulations.
#include "likelihood/start_state.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace sysid {
namespace {

constexpr int iterations = 6;
// A perturbation should move the outputs by this fraction of their size: small against curvature, large against rounding.
constexpr double relative_effect = 1e-4;

Experiment window_of(Experiment const& experiment, int rows) {
  Experiment window = experiment;
  auto const n = static_cast<std::size_t>(rows);
  window.time.resize(n);
  for (auto& channel : window.measured)
    if (!channel.empty()) channel.resize(n);
  window.scored.assign(n, 1);
  return window;
}

int clamp_rows(Experiment const& experiment, int rows) { return std::min(rows, static_cast<int>(experiment.time.size())); }

}  // namespace

StartState::StartState(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, int rows,
                       SolverSettings const& solver, ExecutionOptions options, std::shared_ptr<ThreadPool> pool)
    : compiled_(std::move(compiled)),
      rows_(clamp_rows(experiment, rows)),
      simulator_(compiled_->trajectory,
                 Schedule(*compiled_->trajectory, window_of(experiment, clamp_rows(experiment, rows)), solver), options,
                 std::move(pool)) {
  for (std::size_t r = 0; r < compiled_->records.size(); ++r) {
    auto const& record = compiled_->records[r];
    if (record.kind != CompiledModel::Record::Kind::centre) continue;
    auto const& channel = experiment.measured[static_cast<std::size_t>(record.index)];
    if (channel.empty()) continue;
    std::vector<double> samples(channel.begin(), channel.begin() + rows_);
    double sum = 0, square = 0;
    int n = 0;
    for (double const y : samples)
      if (!std::isnan(y)) sum += y, ++n;
    if (n == 0) continue;
    for (double const y : samples)
      if (!std::isnan(y)) square += (y - sum / n) * (y - sum / n);
    record_.push_back(static_cast<int>(r));
    weights_.push_back(square > 0 ? 1 / std::sqrt(square / n) : 1.0);
    samples_.push_back(std::move(samples));
    count_ += rows_;
    data_norm_ += n;
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

void StartState::estimate(Lanes parameters) const {
  int const width = parameters.width(), states = static_cast<int>(compiled_->model.states.size());
  int const first = parameters.rows() - states;
  {
    // The kernel reads the model's parameters only.
    ConstLanes const own(parameters.data(), first, width, parameters.stride());
    Lanes const start(parameters.data() + static_cast<std::ptrdiff_t>(first) * parameters.stride(), states, width,
                      parameters.stride());
    run(compiled_->initial, own, start);
  }
  if (count_ == 0) return;
  // Columns: W unperturbed, then W per state.
  LaneArray batch(parameters.rows(), width * (states + 1)), residual;
  LaneArray step(states, width);
  for (int s = 0; s < states; ++s)
    for (int w = 0; w < width; ++w) step(s, w) = 1e-6;
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    for (int r = 0; r < parameters.rows(); ++r)
      for (int k = 0; k <= states; ++k)
        for (int w = 0; w < width; ++w)
          batch(r, k * width + w) = parameters(r, w) + (k > 0 && r == first + k - 1 ? step(k - 1, w) : 0.0);
    residuals(batch, residual);
    for (int w = 0; w < width; ++w) {
      Eigen::MatrixXd jacobian(count_, states);
      Eigen::VectorXd base(count_);
      for (int i = 0; i < count_; ++i) {
        base(i) = residual(i, w);
        for (int s = 0; s < states; ++s) jacobian(i, s) = (residual(i, (s + 1) * width + w) - residual(i, w)) / step(s, w);
      }
      if (!base.allFinite() || !jacobian.allFinite())
        continue;  // this lane fails in the simulation that follows, and is counted there
      for (int s = 0; s < states; ++s) {
        double const effect = jacobian.col(s).norm();
        if (effect > 0) step(s, w) = relative_effect * data_norm_ / effect;
      }
      if (iteration == 0) continue;  // the first round only finds the sizes of the perturbations
      Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
      for (int s = 0; s < states; ++s) normal(s, s) += 1e-10 * normal(s, s) + (normal(s, s) == 0 ? 1.0 : 0.0);
      Eigen::VectorXd const move = normal.ldlt().solve(jacobian.transpose() * base);
      if (!move.allFinite()) continue;
      for (int s = 0; s < states; ++s) parameters(first + s, w) -= move(s);
    }
  }
}

}  // namespace sysid
