// Records of the parametric model's trajectory program, as matrices.
#include "likelihood/process/process_rows.hpp"

#include "core/system/memory.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {

ProcessRecord::ProcessRecord(std::shared_ptr<ProcessModel const> model, Experiment const& experiment, SolverSettings const& solver,
                             int start_rows, ExecutionOptions const& options, std::shared_ptr<ThreadPool> pool)
    : model_(std::move(model)),
      simulator_(model_->parametric()->trajectory, Schedule(*model_->parametric()->trajectory, experiment, solver), options, pool) {
  if (start_rows > 0) start_ = std::make_unique<StartState>(model_->parametric(), experiment, start_rows, solver, options, pool);
  for (std::size_t c = 0; c < model_->channels().size(); ++c) {
    fitted_.emplace_back();
    for (int i = 0; i < samples(); ++i)
      if (simulator_.schedule().summed(static_cast<int>(c), i)) fitted_.back().push_back(i);
  }
}

Eigen::VectorXd ProcessRecord::measured(int channel) const {
  std::vector<int> const& samples = fitted(channel);
  Eigen::VectorXd values(static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i)
    values(static_cast<Eigen::Index>(i)) = measured_sample(experiment(), channel, samples[i]);
  return values;
}

ProcessRecord::Records ProcessRecord::run(ConstLanes parameters) const {
  Records result{LaneArray(model_->parametric()->parameter_rows(), parameters.width()),
                 {},
                 std::vector<Outcome>(static_cast<std::size_t>(parameters.width()))};
  for (int r = 0; r < parameters.rows(); ++r)
    for (int w = 0; w < parameters.width(); ++w) result.parameters(r, w) = parameters(r, w);
  if (start_) start_->estimate(result.parameters);
  int const rows = recorded_numbers(samples(), static_cast<int>(model_->parametric()->records.size()));
  result.values = LaneArray(rows, parameters.width());
  simulator_.records(result.parameters, 0, samples(), result.values, result.outcome);
  return result;
}

ProcessRows ProcessRecord::rows(Records const& records, int channel, int lane, std::vector<int> const& samples) const {
  ProcessChannel const& layout = model_->channels()[static_cast<std::size_t>(channel)];
  auto const count = static_cast<Eigen::Index>(samples.size());
  int const per_sample = static_cast<int>(model_->parametric()->records.size());
  ProcessRows rows{Eigen::MatrixXd(count, static_cast<Eigen::Index>(layout.arguments.size())), Eigen::VectorXd(count),
                   Eigen::MatrixXd(count, static_cast<Eigen::Index>(layout.slopes.size()))};
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const at = [&](int record) { return records.values(samples[static_cast<std::size_t>(i)] * per_sample + record, lane); };
    rows.parametric(i) = at(layout.centre);
    for (Eigen::Index d = 0; d < rows.inputs.cols(); ++d) rows.inputs(i, d) = at(layout.arguments[static_cast<std::size_t>(d)]);
    for (Eigen::Index p = 0; p < rows.slopes.cols(); ++p) rows.slopes(i, p) = at(layout.slopes[static_cast<std::size_t>(p)]);
  }
  return rows;
}

}  // namespace sysid
