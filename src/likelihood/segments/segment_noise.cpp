// Sums of squared residuals, the noise that they give, and rows divided by it.
#include "likelihood/segments/segment_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "likelihood/segments/coefficient_prior.hpp"

namespace sysid {
std::vector<double> squares_of(SegmentSimulation const& simulation, std::vector<SegmentSlopes> const& slopes) {
  std::vector<double> squares(static_cast<std::size_t>(simulation.channels()), 0);
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    Eigen::Index const rows = simulation.rows_of_channel(static_cast<int>(s));
    for (int c = 0; c < simulation.channels(); ++c)
      squares[static_cast<std::size_t>(c)] += slopes[s].residual.segment(c * rows, rows).squaredNorm();
  }
  return squares;
}

std::vector<double> noise_of(SegmentSimulation const& simulation, std::span<double const> squares, double used) {
  double total = 0;
  for (int c = 0; c < simulation.channels(); ++c) total += simulation.samples_of_channel(c);
  double const left = std::max(1 - used / std::max(total, 1.0), 1 / std::max(total, 1.0));
  std::vector<double> sds;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const n = std::max(1, simulation.samples_of_channel(c)) * left;
    sds.push_back(std::max(std::sqrt(squares[static_cast<std::size_t>(c)] / n), simulation.least_noise(c)));
  }
  return sds;
}

double log_likelihood_of(SegmentSimulation const& simulation, std::span<double const> squares) {
  std::vector<double> const sds = noise_of(simulation, squares, 0);
  double sum = 0;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const sd = sds[static_cast<std::size_t>(c)], n = simulation.samples_of_channel(c);
    if (n == 0) continue;
    sum -= n / 2 * elementary::log(2 * std::numbers::pi * sd * sd) + squares[static_cast<std::size_t>(c)] / (2 * sd * sd) +
           simulation.log_relative(c);
  }
  return sum;
}

double signal_of(SegmentSimulation const& simulation, std::span<double const> noise_sd) {
  double total = 0, ratio = 0;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const n = simulation.samples_of_channel(c);
    total += n;
    ratio += n * 2 * elementary::log(simulation.size(c) / noise_sd[static_cast<std::size_t>(c)]);
  }
  return signal_of(total, total > 0 ? elementary::exp(ratio / total) : 1);
}

SegmentSlopes weighted(SegmentSimulation const& simulation, SegmentSlopes slopes, int segment, std::span<double const> noise_sd) {
  Eigen::Index const rows = simulation.rows_of_channel(segment);
  for (int c = 0; c < simulation.channels(); ++c) {
    double const weight = 1 / noise_sd[static_cast<std::size_t>(c)];
    slopes.residual.segment(c * rows, rows) *= weight;
    slopes.by_coefficient.middleRows(c * rows, rows) *= weight;
    slopes.by_start.middleRows(c * rows, rows) *= weight;
  }
  return slopes;
}

std::vector<SegmentSlopes> weighted(SegmentSimulation const& simulation, std::vector<SegmentSlopes> slopes,
                                    std::span<double const> noise_sd) {
  for (std::size_t s = 0; s < slopes.size(); ++s)
    slopes[s] = weighted(simulation, std::move(slopes[s]), static_cast<int>(s), noise_sd);
  return slopes;
}

}  // namespace sysid
