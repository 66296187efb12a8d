// The filter runs in lanes, a few parameter vectors at a time so that long records fit in memory; the way back is one by one.
#include "likelihood/smoothing/smoother.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/system/memory.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr double bytes_at_once = 64e6;  // of records
constexpr int vectors_at_once = 64;

Quantity const& quantity_of(Model const& model, SmoothedKind const& kind) {
  auto const index = static_cast<std::size_t>(kind.index);
  switch (kind.kind) {
    case SmoothedKind::Kind::state:
      return model.states[index];
    case SmoothedKind::Kind::derived:
      return model.derived[index];
    case SmoothedKind::Kind::average:
      break;
  }
  return model.disturbances[index];
}

}  // namespace

Smoother::Smoother(std::shared_ptr<SmoothingProgram const> smoothing, Experiment const& experiment, SolverSettings const& solver,
                   int start_rows, ExecutionOptions options)
    : smoothing_(std::move(smoothing)),
      pool_(make_pool(options)),
      simulator_(smoothing_->program, Schedule(*smoothing_->program, experiment, solver), options, pool_) {
  CompiledModel const& compiled = *smoothing_->compiled;
  if (start_rows > 0) start_ = std::make_unique<StartState>(smoothing_->compiled, experiment, start_rows, solver, options, pool_);
  for (SmoothedKind const& kind : smoothing_->shown) {
    Quantity const& quantity = quantity_of(compiled.model, kind);
    quantities_.push_back({quantity.name, quantity.unit_of_numbers(), kind.kind == SmoothedKind::Kind::average});
  }
  bool const map = compiled.model.dynamics == Dynamics::discrete;
  for (std::size_t i = 0; i + 1 < experiment.time.size(); ++i)
    lengths_.push_back(map ? 1 : experiment.time[i + 1] - experiment.time[i]);
}

int Smoother::at_once(int width) const {
  std::int64_t const rows = std::int64_t{samples()} * smoothing_->layout.count;
  if (rows > std::numeric_limits<int>::max())
    throw UserError({Severity::error,
                     "E5003",
                     fmt::format("smoothing {} samples needs more memory than the program supports", samples()),
                     std::nullopt,
                     {},
                     "fit a shorter record"});
  double const bytes = sizeof(double) * static_cast<double>(rows);
  if (bytes > bytes_at_once)
    require_memory(fmt::format("smoothing the states of {} samples", samples()), 2 * bytes, "fit a shorter record");
  return std::clamp(static_cast<int>(bytes_at_once / bytes), 1, std::min(width, vectors_at_once));
}

std::vector<Smoother::Path> Smoother::run(ConstLanes parameters) const {
  std::vector<Path> paths(static_cast<std::size_t>(parameters.width()));
  if (paths.empty()) return paths;
  int const width = at_once(parameters.width());
  for (int first = 0; first < parameters.width(); first += width) {
    int const lanes = std::min(width, parameters.width() - first);
    LaneArray block(smoothing_->compiled->parameter_rows(), lanes);
    for (int r = 0; r < parameters.rows(); ++r)
      for (int w = 0; w < lanes; ++w) block(r, w) = parameters(r, first + w);
    if (start_) start_->estimate(block);
    LaneArray records(samples() * smoothing_->layout.count, lanes);
    std::vector<Outcome> outcome(static_cast<std::size_t>(lanes));
    simulator_.records(block, 0, samples(), records, outcome);
    Work work;
    work.instructions = 100.0 * smoothing_->layout.count * samples() * lanes;
    work.given_up = simulator_.given_up();
    work.width = lanes;
    work.blocks = [&](int begin, int count) {
      Blocks blocks{{}, work.instructions / lanes * count};
      for (int w = begin; w < begin + count; ++w)
        if (outcome[static_cast<std::size_t>(w)].ok)
          blocks.all.emplace_back([&, w] {
            if (!simulator_.stopped()) paths[static_cast<std::size_t>(first + w)] = path(block, records, w);
          });
      return blocks;
    };
    do_work({&work, 1}, pool_.get());
  }
  return paths;
}

Smoother::Path Smoother::path(ConstLanes parameters, ConstLanes records, int lane) const {
  Model const& model = smoothing_->compiled->model;
  SmoothedPath const smoothed = smooth(smoothing_->layout, records, lane, lengths_);
  auto const count = static_cast<std::size_t>(samples()), n = static_cast<std::size_t>(smoothing_->layout.states);
  Path path;
  path.mean.resize(quantities_.size() * count);
  path.sd.resize(path.mean.size());
  bool derived = false;
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    SmoothedKind const& kind = smoothing_->shown[q];
    auto const index = static_cast<std::size_t>(kind.index);
    for (std::size_t i = 0; i < count; ++i) {
      double mean = 0, variance = 0;
      if (kind.kind == SmoothedKind::Kind::state) {
        mean = smoothed.mean[i * n + index];
        variance = smoothed.covariance[(i * n + index) * n + index];
      } else if (kind.kind == SmoothedKind::Kind::average) {
        mean = smoothed.average[index * count + i];
        variance = smoothed.average_variance[index * count + i];
      }
      path.mean[q * count + i] = mean;
      path.sd[q * count + i] = variance <= 0 ? 0 : std::sqrt(variance);
    }
    derived = derived || kind.kind == SmoothedKind::Kind::derived;
  }
  if (derived) add_derived(parameters, lane, smoothed, path);
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    Quantity const& quantity = quantity_of(model, smoothing_->shown[q]);
    for (std::size_t i = q * count; i < (q + 1) * count; ++i) {
      path.mean[i] = quantity.from_si(path.mean[i]);
      path.sd[i] = quantity.from_si(path.sd[i]);
    }
  }
  path.solved = true;
  return path;
}

/// Values at the smoothed means, with variances to first order.
void Smoother::add_derived(ConstLanes parameters, int lane, SmoothedPath const& smoothed, Path& path) const {
  constexpr int most = 1024;  // samples at once
  Kernel const& kernel = smoothing_->derived;
  int const n = smoothing_->layout.states, first_leaf = parameters.rows() + n;
  for (int from = 0; from < samples(); from += most) {
    int const count = std::min(most, samples() - from);
    LaneArray inputs(kernel.inputs, count), outputs(kernel.outputs, count);
    for (int r = 0; r < parameters.rows(); ++r)
      for (int i = 0; i < count; ++i) inputs(r, i) = parameters(r, lane);
    for (int s = 0; s < n; ++s)
      for (int i = 0; i < count; ++i)
        inputs(parameters.rows() + s, i) = smoothed.mean[static_cast<std::size_t>((from + i) * n + s)];
    for (std::size_t k = 0; k < smoothing_->leaves.size(); ++k)
      for (int i = 0; i < count; ++i)
        inputs(first_leaf + static_cast<int>(k), i) = simulator_.schedule().at_sample(smoothing_->leaves[k], from + i);
    sysid::run(kernel, inputs, outputs);
    int row = 0;
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      if (smoothing_->shown[q].kind != SmoothedKind::Kind::derived) continue;
      for (int i = 0; i < count; ++i) {
        double const* const covariance = smoothed.covariance.data() + static_cast<std::ptrdiff_t>(from + i) * n * n;
        double variance = 0;
        for (int a = 0; a < n; ++a)
          for (int b = 0; b < n; ++b) variance += outputs(row + 1 + a, i) * covariance[a * n + b] * outputs(row + 1 + b, i);
        std::size_t const place = q * static_cast<std::size_t>(samples()) + static_cast<std::size_t>(from + i);
        path.mean[place] = outputs(row, i);
        path.sd[place] = variance <= 0 ? 0 : std::sqrt(variance);
      }
      row += 1 + n;
    }
  }
}

}  // namespace sysid
