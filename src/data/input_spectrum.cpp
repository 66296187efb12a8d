// Fourier transforms of the record, padded to a power of two.
#include "data/input_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/numeric/periodogram.hpp"

namespace sysid {
namespace {

constexpr double excluded_share = 0.005;  // of the power, at either end of the band
constexpr double top_of_band = 0.4;       // of the sampling rate
constexpr double little_at_top = 1e-3, much_left_out = 0.005;

// At the middle of each interval, where a spline and its chord are farthest apart.
double chord_error(InputSignal const& signal, double sd) {
  InputSignal const curve = *signal.under(InputRule::cubic);
  double square = 0;
  for (int i = 0; i + 1 < signal.rows(); ++i) {
    double const apart = curve.value(i, 0.5) - (signal.sample(i) + signal.sample(i + 1)) / 2;
    square += apart * apart;
  }
  return std::sqrt(square / (signal.rows() - 1)) / sd;
}

void fill_band(std::vector<double> const& power, double rate, InputSpectrum& result) {
  double total = 0, sum = 0;
  for (double const each : power) total += each;
  bool begun = false;
  for (std::size_t k = 0; k < power.size(); ++k) {
    sum += power[k];
    double const frequency = rate * static_cast<double>(k) / static_cast<double>(2 * (power.size() - 1));
    if (!begun && sum > excluded_share * total) begun = true, result.low = frequency;
    result.high = frequency;
    if (sum >= (1 - excluded_share) * total) break;
  }
}

double top_share(std::vector<double> samples) {
  taper(samples);
  std::vector<double> const power = periodogram(std::move(samples));
  double total = 0, top = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    total += power[k];
    if (static_cast<double>(k) > top_of_band * static_cast<double>(2 * (power.size() - 1))) top += power[k];
  }
  return total > 0 ? top / total : 0;
}

}  // namespace

InputSpectrum input_spectrum(InputSignal const& signal, double rate) {
  InputSpectrum result;
  std::vector<double> samples;
  for (int i = 0; i < signal.rows(); ++i) samples.push_back(signal.sample(i));
  double const rows = static_cast<double>(samples.size());
  double mean = 0, square = 0;
  for (double const each : samples) mean += each / rows;
  for (double& each : samples) each -= mean;
  for (double const each : samples) square += each * each;
  result.constant = !(square > 1e-20 * mean * mean * rows);
  if (result.constant) return result;
  fill_band(periodogram(samples), rate, result);
  result.top = top_share(samples);
  result.chords = chord_error(signal, std::sqrt(square / rows));
  return result;
}

bool cut_by_lines(InputSpectrum const& spectrum) {
  return !spectrum.constant && spectrum.top < little_at_top && spectrum.chords > much_left_out;
}

}  // namespace sysid
