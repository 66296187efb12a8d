// One spline per channel of an experiment, on first use.
#include "experiment/start_guess.hpp"

#include <algorithm>
#include <cmath>

#include "regression/column/signals.hpp"

namespace sysid {
namespace {

constexpr int highest_rise = 3;  // what the spline can be differentiated
constexpr std::size_t least_rows = 6;
/// Rows from which the smoothness is taken: each of its trials is a spline.
constexpr std::size_t rows_for_penalty = 1000;

}  // namespace

StartGuess::StartGuess(regression::Dictionary const& dictionary, std::span<Experiment const> experiments,
                       std::vector<double> noise_sd)
    : dictionary_(dictionary), experiments_(experiments), noise_sd_(std::move(noise_sd)) {}

double StartGuess::value(int experiment, int row, int state, int order) {
  int const channel = regression::base_channel(dictionary_, state, order);
  if (channel < 0) return 0;
  auto const c = static_cast<std::size_t>(channel);
  int const rise = order - dictionary_.channels[c].order;
  Experiment const& from = experiments_[static_cast<std::size_t>(experiment)];
  std::vector<double> const& samples = from.measured[c];
  auto const finite =
      static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(), [](double y) { return std::isfinite(y); }));
  if (rise > highest_rise || finite < least_rows) return 0;
  auto const [place, fresh] = values_.try_emplace({experiment, channel, rise});
  if (fresh) {
    auto spline = splines_.find({experiment, channel});
    if (spline == splines_.end()) {
      std::span<double const> const head(samples.data(), std::min(samples.size(), rows_for_penalty));
      double const penalty = regression::penalty_for_noise(head, noise_sd_[c]);
      spline = splines_.emplace(std::pair(experiment, channel), regression::SmoothingSpline(samples, penalty)).first;
    }
    double const step = (from.time.back() - from.time.front()) / static_cast<double>(from.time.size() - 1);
    place->second = spline->second.derivative(rise);
    for (double& value : place->second) value /= std::pow(step, rise);
  }
  return place->second[static_cast<std::size_t>(row)];
}

}  // namespace sysid
