// A tapered periodogram.
#include "regression/column/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/periodogram.hpp"

namespace sysid::regression {

Spectrum spectrum_of(std::span<double const> samples, double step) {
  std::size_t const n = samples.size();
  std::vector<double> filled(samples.begin(), samples.end());
  std::size_t last = n;  // the finite sample before, n: none
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(filled[i])) continue;
    std::size_t const first = last == n ? 0 : last + 1;
    for (std::size_t k = first; k < i; ++k)
      filled[k] = last == n
                      ? filled[i]
                      : filled[last] + (filled[i] - filled[last]) * static_cast<double>(k - last) / static_cast<double>(i - last);
    last = i;
  }
  if (last == n) return {};
  for (std::size_t k = last + 1; k < n; ++k) filled[k] = filled[last];
  auto const [low, high] = std::minmax_element(filled.begin(), filled.end());
  if (*low == *high) return {};

  double mean = 0;
  for (double const value : filled) mean += value / static_cast<double>(n);
  for (double& value : filled) value -= mean;
  taper(filled);
  Spectrum out{periodogram(std::move(filled))};
  out.size = 2 * (out.power.size() - 1);
  out.length = static_cast<double>(out.size) * step;
  double const share = 2 / (1.5 * static_cast<double>(out.size) * static_cast<double>(n));  // 1.5: the mean square of the taper
  for (double& power : out.power) power *= share;
  return out;
}

double dominant_period(std::span<std::vector<double> const> signals, double step) {
  // On the frequencies of the longest spectrum; a shorter one is read at the nearest of its own.
  std::vector<Spectrum> spectra;
  double length = 0, longest = 0;
  for (std::vector<double> const& signal : signals) {
    spectra.push_back(spectrum_of(signal, step));
    double total = 0;
    for (double const power : spectra.back().power) total += power;
    for (double& power : spectra.back().power) power /= total;
    length = std::max(length, spectra.back().length);
    longest = std::max(longest, static_cast<double>(signal.size()) * step);
  }
  double best = 0, period = 0;
  for (int k = 1; k * step < length / 2; ++k) {
    double const frequency = k / length;
    if (frequency * longest < 3) continue;
    double sum = 0;
    for (Spectrum const& each : spectra) {
      auto const place = static_cast<std::size_t>(std::lround(frequency * each.length));
      if (place < each.power.size()) sum += each.power[place] * each.length / length;
    }
    if (sum > best) best = sum, period = 1 / frequency;
  }
  return period;
}

}  // namespace sysid::regression
