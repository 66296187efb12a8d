// Records of the densities, a few dozen parameter vectors at a time so that long records fit in memory.
#include "likelihood/pointwise.hpp"

#include <algorithm>

#include "core/system/memory.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {
namespace {

constexpr int densities_at_once = 64;

}  // namespace

PointwiseLikelihood::PointwiseLikelihood(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment,
                                         SolverSettings const& solver, int start_rows, ExecutionOptions options)
    : compiled_(std::move(compiled)), simulator_([&] {
        bool const ahead = compiled_->model.filtered() && !experiment.corrects.empty();
        auto const program = compile_densities(*compiled_, ahead);
        return Simulator(program, Schedule(*program, with_corrections(compiled_->model, experiment), solver), options);
      }()) {
  if (start_rows > 0) start_ = std::make_unique<StartState>(compiled_, experiment, start_rows, solver, options);
  samples_.resize(compiled_->model.channels.size());
  for (std::size_t c = 0; c < samples_.size(); ++c)
    for (int i = 0; i < simulator_.schedule().samples(); ++i)
      if (experiment.is_scored(c, static_cast<std::size_t>(i))) {
        samples_[c].push_back(i);
        end_ = std::max(end_, i + 1);
      }
}

void PointwiseLikelihood::records(ConstLanes parameters, int first_row, int last_row, Lanes out) const {
  for (int first = 0; first < parameters.width(); first += densities_at_once) {
    int const width = std::min(densities_at_once, parameters.width() - first);
    LaneArray block(compiled_->parameter_rows(), width);
    for (int r = 0; r < parameters.rows(); ++r)
      for (int w = 0; w < width; ++w) block(r, w) = parameters(r, first + w);
    if (start_) start_->estimate(block);
    std::vector<Outcome> outcome(static_cast<std::size_t>(width));
    simulator_.records(block, first_row, last_row, out.columns(first, width), outcome);
  }
}

std::vector<std::vector<std::vector<double>>> PointwiseLikelihood::run(ConstLanes parameters) const {
  std::vector<std::vector<std::vector<double>>> values(samples_.size());
  int const last = end_;
  for (int first = 0; first < parameters.width(); first += densities_at_once) {
    int const width = std::min(densities_at_once, parameters.width() - first);
    LaneArray out(recorded_numbers(last, channels()), width);
    records(parameters.columns(first, width), 0, last, out);
    for (int c = 0; c < channels(); ++c)
      for (int w = 0; w < width; ++w) {
        values[static_cast<std::size_t>(c)].emplace_back();
        for (int const i : samples(c)) values[static_cast<std::size_t>(c)].back().push_back(out(i * channels() + c, w));
      }
  }
  return values;
}

}  // namespace sysid
