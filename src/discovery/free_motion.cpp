// Bands of a single trajectory.
#include "discovery/free_motion.hpp"

#include <algorithm>
#include <cmath>

#include "diagnostics/bands.hpp"
#include "diagnostics/scores.hpp"

namespace sysid {
namespace {

constexpr double bound_factor = 10;

template <class Values>
void begin_at(Values& values, int first) {
  if (!values.empty()) values.erase(values.begin(), values.begin() + first);
}

/// Rows of the run in which all its channels are finite and within their bounds.
std::size_t bounded_rows(FreeMotion const& run, Experiment const& experiment, std::span<std::size_t const> channels) {
  std::size_t rows = run.channels.front().size();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    Bounds const bounds(experiment.measured[channels[k]]);
    std::vector<double> const& values = run.channels[k];
    auto const left = std::find_if_not(values.begin(), values.end(), [&](double each) { return bounds.hold(each); });
    rows = std::min(rows, static_cast<std::size_t>(left - values.begin()));
  }
  return rows;
}

}  // namespace

Bounds::Bounds(std::vector<double> const& measured) {
  for (double const each : measured)
    if (std::isfinite(each)) low_ = std::min(low_, each), high_ = std::max(high_, each);
}

bool Bounds::hold(double value) const {
  if (!std::isfinite(value)) return false;
  return low_ > high_ || std::abs(value - (low_ + high_) / 2) <= bound_factor * (high_ - low_) / 2;
}

Prediction shown_motion(FreeMotion const& run, Experiment const& experiment, Model const& measured,
                        std::span<std::size_t const> channels) {
  Prediction out = record_along(experiment, measured);
  out.rows = false;
  begin_at(out.time, run.first);
  begin_at(out.scored, run.first);
  for (PredictedInput& input : out.inputs) begin_at(input.values, run.first);
  for (std::size_t i = 0; i < out.scored.size(); ++i) out.scored[i] = i < static_cast<std::size_t>(run.window) ? 0 : 1;
  std::size_t const bounded = bounded_rows(run, experiment, channels);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    Channel const& channel = measured.channels[channels[k]];
    std::vector<double> values(run.channels[k].size(), std::nan("")), samples = experiment.measured[channels[k]];
    for (std::size_t i = 0; i < bounded; ++i) values[i] = channel.from_si(run.channels[k][i]);
    begin_at(samples, run.first);
    for (double& each : samples) each = channel.from_si(each);
    Band band{.mean = values, .sd = std::vector<double>(values.size(), 0.0), .lower = values, .upper = values, .draws = 1};
    out.quantities.push_back({channel.name, channel.unit_text(), std::move(band), {}, std::move(samples)});
  }
  return out;
}

}  // namespace sysid
