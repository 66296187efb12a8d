// One pass over the numbers, and what follows from it.
#include "data/look/column_look.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/periodogram.hpp"
#include "core/system/interrupt.hpp"
#include "data/cell/stuck_sensor.hpp"

namespace sysid {
namespace {

/// For how many rows the column usually keeps a value: 1 for a sensor, the ratio of the rates for the command of a converter that
/// is recorded faster.
std::size_t rows_held(std::vector<double> const& values) {
  std::vector<std::size_t> runs;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (i > 0 && values[i] == values[i - 1] && !runs.empty())
      ++runs.back();
    else
      runs.push_back(1);
  }
  if (runs.empty()) return 1;
  auto const middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end());
  return *middle;
}

/// Samples at `value` in runs longer than the column is held elsewhere, and of at least three, where there are enough of them to be
/// no chance.
std::size_t in_runs_at(std::vector<double> const& values, double value, std::size_t held) {
  std::size_t const shortest = std::max<std::size_t>(3, held + 1);
  std::size_t all = 0, run = 0;
  for (std::size_t i = 0; i <= values.size(); ++i) {
    if (i < values.size() && values[i] == value) {
      ++run;
      continue;
    }
    if (run >= shortest) all += run;
    run = 0;
  }
  return all >= 5 && all * 1000 >= values.size() ? all : 0;
}

/// The step of a converter: the least difference, if all others are multiples of it.
double quantum_of(std::vector<double> const& levels) {
  constexpr std::size_t fewest = 4;
  if (levels.size() < fewest) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < levels.size(); ++i) least = std::min(least, levels[i] - levels[i - 1]);
  double const range = levels.back() - levels.front();
  if (range / least > 1e9) return 0;
  // Sums of a few differences give the step to more digits than the least one alone.
  double const step = range / std::round(range / least);
  for (double const level : levels) {
    double const multiple = (level - levels.front()) / step;
    if (std::fabs(multiple - std::round(multiple)) > 1e-3 + 1e-6 * std::fabs(multiple)) return 0;
  }
  return step;
}

struct Line {
  double begin = 0, slope = 0, spread = 0;  // over rows
};
Line line_through(std::vector<double> const& values) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    double const x = static_cast<double>(i) - 0.5 * static_cast<double>(values.size());
    n += 1, sx += x, sy += values[i], sxx += x * x, sxy += x * values[i];
  }
  Line line;
  double const determinant = n * sxx - sx * sx;
  line.slope = determinant > 0 ? (n * sxy - sx * sy) / determinant : 0;
  double const level = n > 0 ? (sy - line.slope * sx) / n : 0;
  line.begin = level - line.slope * 0.5 * static_cast<double>(values.size());
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    double const residual = values[i] - line.begin - line.slope * static_cast<double>(i);
    if (!std::isnan(residual)) squares += residual * residual;
  }
  line.spread = n > 2 ? std::sqrt(squares / (n - 2)) : 0;
  return line;
}

/// Peaks of the spectrum under a Hann window, the straight line taken off.
std::vector<SpectralPeak> peaks_of(std::vector<double> const& values, Line const& line, double step) {
  constexpr std::size_t fewest = 32, most = std::size_t{1} << 22U, shown = 3;
  std::size_t const rows = std::min(values.size(), most);
  if (rows < fewest || line.spread == 0) return {};
  std::vector<double> detrended(rows);
  for (std::size_t i = 0; i < rows; ++i) detrended[i] = values[i] - line.begin - line.slope * static_cast<double>(i);
  taper(detrended);
  std::vector<double> amplitudes = periodogram(std::move(detrended), &stop_if_interrupted);
  std::size_t const size = 2 * (amplitudes.size() - 1);
  amplitudes.pop_back();
  for (double& each : amplitudes) each = 2 * std::sqrt(each) / static_cast<double>(rows);
  std::vector<SpectralPeak> peaks;
  double const first = 2.5 * static_cast<double>(size) / static_cast<double>(rows);  // below, the window and the line are seen
  for (std::size_t k = 1; k + 1 < amplitudes.size(); ++k)
    if (static_cast<double>(k) >= first && amplitudes[k] > amplitudes[k - 1] && amplitudes[k] >= amplitudes[k + 1]) {
      // A parabola through the logarithms of three points (Hann window: the error is below a tenth of a bin).
      double const a = elementary::log(std::max(amplitudes[k - 1], 1e-300)), b = elementary::log(amplitudes[k]),
                   c = elementary::log(std::max(amplitudes[k + 1], 1e-300));
      double const shift = a - 2 * b + c < 0 ? 0.5 * (a - c) / (a - 2 * b + c) : 0;
      peaks.push_back({(static_cast<double>(k) + shift) / (static_cast<double>(size) * step),
                       amplitudes[k] * elementary::exp(-0.25 * (a - c) * shift)});
    }
  std::sort(peaks.begin(), peaks.end(), [](SpectralPeak const& x, SpectralPeak const& y) { return x.amplitude > y.amplitude; });
  // What stands out of the floor.
  std::vector<double> sorted = amplitudes;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  double const floor = sorted[sorted.size() / 2];
  std::erase_if(peaks, [&](SpectralPeak const& peak) { return peak.amplitude < 6 * floor || peak.amplitude < 0.02 * line.spread; });
  std::vector<SpectralPeak> apart;
  double const resolution = 4 / (static_cast<double>(rows) * step);
  for (SpectralPeak const& peak : peaks)
    if (apart.size() < shown && std::none_of(apart.begin(), apart.end(), [&](SpectralPeak const& other) {
          return std::fabs(other.frequency - peak.frequency) < resolution;
        }))
      apart.push_back(peak);
  return apart;
}

}  // namespace

ColumnLook look_at_column(std::string name, std::vector<double> const& values, double step) {
  ColumnLook look;
  look.name = std::move(name);
  look.rows = values.size();
  std::vector<double> levels;
  for (double const value : values)
    if (!std::isnan(value)) levels.push_back(value);
  look.missing = values.size() - levels.size();
  if (levels.empty()) return look;
  look.first = levels.front();
  double sum = 0, squares = 0;
  for (double const value : levels) sum += value;
  look.mean = sum / static_cast<double>(levels.size());
  for (double const value : levels) squares += (value - look.mean) * (value - look.mean);
  look.sd = levels.size() > 1 ? std::sqrt(squares / static_cast<double>(levels.size() - 1)) : 0;
  std::sort(levels.begin(), levels.end());
  look.smallest = levels.front();
  look.largest = levels.back();
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  look.levels = levels.size();
  look.dead = look.levels == 1 && values.size() > 1;
  if (look.dead) return look;
  constexpr std::size_t few_levels = 8;  // a switch, or steps of a command, is at its ends most of the time
  if (look.levels > few_levels) {
    std::size_t const held = rows_held(values);
    look.at_smallest = in_runs_at(values, look.smallest, held);
    look.at_largest = in_runs_at(values, look.largest, held);
    if (auto const run = frozen_run(values)) {
      look.frozen_first = run->first + 1;
      look.frozen_last = run->last + 1;
    }
  }
  look.quantum = quantum_of(levels);
  Line const line = line_through(values);
  double const drift = line.slope * static_cast<double>(values.size() - 1);
  constexpr std::size_t few_rows = 20;  // of fewer any line is one
  if (values.size() >= few_rows && std::fabs(drift) > 2 * line.spread) look.drift = drift;
  if (step > 0 && look.missing == 0) look.peaks = peaks_of(values, line, step);
  return look;
}

}  // namespace sysid
