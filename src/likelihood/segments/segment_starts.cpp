// Damped least squares per segment, all segments simulated side by side.
#include "likelihood/segments/segment_starts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "likelihood/segments/arrowhead.hpp"
#include "likelihood/segments/damping.hpp"
#include "likelihood/segments/segment_differences.hpp"
#include "likelihood/segments/segment_noise.hpp"

namespace sysid {
namespace {

constexpr double enough = 1e-4;  // gain of log likelihood
constexpr int most_start_rounds = 40;
/// Of what starts differ by: how far one is moved that leads to nothing finite.
constexpr double nudges[] = {0.02, 0.05, 0.1, 0.2};

/// What a state may be moved in proportion to: what its starts differ by; of one segment, which tells nothing, what channels vary
/// by.
std::vector<double> sizes_of_starts(SegmentSimulation const& simulation, ShootingPoint const& guess, Eigen::Index state) {
  double const mean = guess.starts.row(state).mean(), spread = (guess.starts.row(state).array() - mean).matrix().norm();
  if (spread > 0) return {spread / std::sqrt(static_cast<double>(guess.starts.cols()))};
  std::vector<double> sizes;
  for (int c = 0; c < simulation.channels(); ++c) sizes.push_back(simulation.size(c));
  return sizes;
}

/// Where a segment diverges from its start, one that lies a little to the side: near zero, noise takes a population or a
/// concentration below it, where equations of positive quantities run away.
void nudge_diverging(SegmentSimulation const& simulation, ShootingPoint& point) {
  std::vector<SegmentSlopes> const first = simulation.residuals(point);
  Eigen::Index const states = point.starts.rows(), count = point.starts.cols();
  std::vector<bool> lost;
  for (SegmentSlopes const& each : first) lost.push_back(!each.finite());
  ShootingPoint const guess = point;
  std::vector<double> best(static_cast<std::size_t>(count), std::numeric_limits<double>::infinity());
  auto const squares = [&](SegmentSlopes const& each, Eigen::Index s) {
    double sum = 0;
    Eigen::Index const rows = simulation.rows_of_channel(static_cast<int>(s));
    for (int c = 0; c < simulation.channels(); ++c)
      sum += each.residual.segment(c * rows, rows).squaredNorm() / (simulation.size(c) * simulation.size(c));
    return each.finite() ? sum : std::numeric_limits<double>::infinity();
  };
  auto const attempt = [&](Eigen::Index x, double by) {
    ShootingPoint trial = guess;
    trial.starts.row(x).array() += by;
    std::vector<SegmentSlopes> const there = simulation.residuals(trial);
    for (Eigen::Index s = 0; s < count; ++s) {
      auto const i = static_cast<std::size_t>(s);
      if (!lost[i] || !(squares(there[i], s) < best[i])) continue;
      best[i] = squares(there[i], s);
      point.starts.col(s) = trial.starts.col(s);
    }
  };
  for (double const nudge : nudges) {
    for (Eigen::Index x = 0; x < states; ++x)
      for (double const size : sizes_of_starts(simulation, guess, x))
        for (double const side : {nudge, -nudge}) {
          if (std::none_of(lost.begin(), lost.end(), [](bool each) { return each; })) return;
          attempt(x, side * size);
        }
    for (std::size_t s = 0; s < lost.size(); ++s) lost[s] = lost[s] && !std::isfinite(best[s]);
  }
}

}  // namespace

void fit_starts(SegmentSimulation const& simulation, ShootingPoint& point, std::span<double const> noise_sd,
                std::function<bool()> const& interrupted) {
  if (simulation.states() == 0) return;
  nudge_diverging(simulation, point);
  SegmentDifferences differences(simulation, point);
  std::vector<SegmentSlopes> slopes = differences.at(point, most_probes);
  std::size_t const count = slopes.size();
  std::vector<Damping> damping(count);
  std::vector<bool> done(count, false);
  auto const cost = [&](SegmentSlopes const& each, std::size_t s) {
    double const squares = weighted(simulation, each, static_cast<int>(s), noise_sd).residual.squaredNorm();
    return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  };
  for (std::size_t s = 0; s < count; ++s) done[s] = !slopes[s].finite();
  for (int round = 0; round < most_start_rounds; ++round) {
    if (interrupted && interrupted()) return;
    ShootingPoint trial = point;
    bool open = false;
    for (std::size_t s = 0; s < count; ++s) {
      if (done[s]) continue;
      SegmentSlopes const here = weighted(simulation, slopes[s], static_cast<int>(s), noise_sd);
      Eigen::VectorXd const move = eliminate(here, damping[s].value()).start(Eigen::VectorXd::Zero(simulation.coefficients()));
      double const gain = (here.residual.squaredNorm() - (here.residual + here.by_start * move).squaredNorm()) / 2;
      done[s] = !(gain >= enough);
      if (done[s]) continue;
      trial.starts.col(static_cast<Eigen::Index>(s)) += move;
      open = true;
    }
    if (!open) return;
    std::vector<SegmentSlopes> const there = differences.at(trial, 0);
    for (std::size_t s = 0; s < count; ++s) {
      if (done[s]) continue;
      auto const i = static_cast<Eigen::Index>(s);
      if (cost(there[s], s) <= cost(slopes[s], s)) {
        point.starts.col(i) = trial.starts.col(i);
        slopes[s] = there[s];
        damping[s].less();
      } else {
        damping[s].more();
        done[s] = damping[s].exhausted();
      }
    }
  }
}

}  // namespace sysid
