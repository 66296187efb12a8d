// Splines of the samples that are there; divided differences by their weights.
#include "discovery/preparation/equal_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

constexpr double near_steps = 2;      // mean steps to the next sample
constexpr double least_apart = 1e-3;  // mean steps: closer samples are one
constexpr std::size_t points = 7;     // of a sixth difference

struct FiniteSamples {
  std::vector<double> time, value;
};

FiniteSamples finite_samples(std::span<double const> time, std::span<double const> value) {
  FiniteSamples out;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (std::isfinite(value[i])) out.time.push_back(time[i]), out.value.push_back(value[i]);
  return out;
}

/// Samples nearer to each other than `least` are one, at their mean time: a spline through both would swing.
FiniteSamples apart(FiniteSamples const& from, double least) {
  FiniteSamples out;
  std::size_t joined = 0;
  for (std::size_t i = 0; i < from.time.size(); ++i) {
    if (i > 0 && from.time[i] - from.time[i - 1] < least) {
      auto const count = static_cast<double>(++joined);
      out.time.back() += (from.time[i] - out.time.back()) / (count + 1);
      out.value.back() += (from.value[i] - out.value.back()) / (count + 1);
      continue;
    }
    joined = 0;
    out.time.push_back(from.time[i]);
    out.value.push_back(from.value[i]);
  }
  return out;
}

/// The interval of `time` that holds t, which lies within it.
int interval_of(std::vector<double> const& time, double t) {
  auto const after = std::upper_bound(time.begin(), time.end() - 1, t) - time.begin();
  return static_cast<int>(std::max<std::ptrdiff_t>(after, 1)) - 1;
}

/// The mean of a held input over [begin, end].
double held_mean(InputSignal const& input, std::vector<double> const& time, double begin, double end) {
  double sum = 0;
  for (int i = interval_of(time, begin); i + 1 < static_cast<int>(time.size()); ++i) {
    auto const at = static_cast<std::size_t>(i);
    double const from = std::max(begin, time[at]), to = std::min(end, time[at + 1]);
    if (from >= end) break;
    if (to > from) sum += input.sample(i) * (to - from);
  }
  return end > begin ? sum / (end - begin) : input.sample(interval_of(time, begin));
}

double read(InputSignal const& curve, std::vector<double> const& time, double t) {
  int const i = interval_of(time, t);
  auto const at = static_cast<std::size_t>(i);
  return curve.value(i, std::clamp((t - time[at]) / (time[at + 1] - time[at]), 0.0, 1.0));
}

std::vector<double> interpolated(FiniteSamples const& from, std::vector<double> const& grid, double step) {
  std::vector<double> out(grid.size(), std::numeric_limits<double>::quiet_NaN());
  if (from.time.size() < 2) return out;
  InputSignal const curve(InputRule::cubic, from.time, from.value);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid[i] < from.time.front() || grid[i] > from.time.back()) continue;
    auto const at = static_cast<std::size_t>(interval_of(from.time, grid[i]));
    double const distance = std::min(grid[i] - from.time[at], from.time[at + 1] - grid[i]);
    if (distance <= near_steps * step) out[i] = read(curve, from.time, grid[i]);
  }
  return out;
}

}  // namespace

Experiment at_equal_steps(Experiment const& experiment) {
  std::vector<double> const& time = experiment.time;
  double const step = mean_step(time);
  Experiment out = experiment;
  for (std::size_t i = 0; i + 1 < time.size(); ++i) out.time[i] = time.front() + static_cast<double>(i) * step;
  for (std::vector<double>& channel : out.measured)
    if (!channel.empty()) channel = interpolated(apart(finite_samples(time, channel), least_apart * step), out.time, step);
  for (InputSignal& input : out.inputs) {
    std::vector<double> samples;
    for (std::size_t i = 0; i < out.time.size(); ++i)
      samples.push_back(input.rule() == InputRule::zero_order && i + 1 < out.time.size()
                            ? held_mean(input, time, out.time[i], out.time[i + 1])
                            : read(input, time, out.time[i]));
    input = InputSignal(input.rule(), out.time, std::move(samples));
  }
  for (std::size_t i = 0; i < out.scored.size(); ++i) {
    auto const at = static_cast<std::size_t>(interval_of(time, out.time[i]));
    out.scored[i] = experiment.scored[at] != 0 && experiment.scored[at + 1] != 0 ? 1 : 0;
  }
  out.has_lags.clear();
  return out;
}

bool fill_missing(Experiment& experiment) {
  constexpr double widest = 4.5;  // mean steps from one measured sample to the next, over which a spline is to be believed
  double const step = mean_step(experiment.time);
  bool filled = false;
  for (std::vector<double>& channel : experiment.measured) {
    FiniteSamples const from = finite_samples(experiment.time, channel);
    if (from.time.size() < 2) continue;
    InputSignal const curve(InputRule::cubic, from.time, from.value);
    for (std::size_t i = 0; i < channel.size(); ++i) {
      double const t = experiment.time[i];
      if (!std::isnan(channel[i]) || t < from.time.front() || t > from.time.back()) continue;
      auto const before = static_cast<std::size_t>(interval_of(from.time, t));
      if (from.time[before + 1] - from.time[before] > widest * step) continue;
      channel[i] = read(curve, from.time, t);
      filled = true;
    }
  }
  return filled;
}

std::optional<double> noise_at_unequal_steps(std::span<double const> time, std::span<double const> samples) {
  FiniteSamples const from = finite_samples(time, samples);
  if (from.time.size() < points) return std::nullopt;
  double squares = 0;
  std::size_t const count = from.time.size() - points + 1;
  for (std::size_t first = 0; first < count; ++first) {
    double sum = 0, weights = 0;
    for (std::size_t i = first; i < first + points; ++i) {
      double weight = 1;
      for (std::size_t j = first; j < first + points; ++j)
        if (j != i) weight *= (from.time[first + points - 1] - from.time[first]) / (from.time[i] - from.time[j]);
      sum += weight * from.value[i];
      weights += weight * weight;
    }
    squares += sum * sum / weights;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace sysid
