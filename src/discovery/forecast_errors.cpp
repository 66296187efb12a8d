// Windows and what follows them are segments.
#include "discovery/forecast_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "likelihood/segments/segment_starts.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double lost = 0.4;  // of the sd

/// Squares of errors of one channel.
struct Mean {
  double squares = 0;
  int count = 0;
  void add(double error) {
    squares += std::isfinite(error) ? error * error : std::numeric_limits<double>::infinity();
    ++count;
  }
  std::optional<double> root() const { return count == 0 ? std::nullopt : std::optional(std::sqrt(squares / count)); }
};

/// With 0 measured in every row: residuals are what is simulated.
std::vector<Experiment> unmeasured(std::span<Experiment const> experiments) {
  std::vector<Experiment> out(experiments.begin(), experiments.end());
  for (Experiment& each : out)
    for (std::vector<double>& channel : each.measured) std::fill(channel.begin(), channel.end(), 0.0);
  return out;
}

/// Simulations of segments from starts that fit their first `window` rows.
class Forecasts {
 public:
  Forecasts(ValidatedModel const& model, Eigen::VectorXd const& coefficients, std::span<double const> noise_sd,
            std::span<Experiment const> experiments, StartGuess& guess, ForecastSettings const& settings,
            std::vector<Segment> const& segments)
      : experiments_(experiments),
        simulation_(model.compiled, unmeasured(experiments), segments, simulated(model, coefficients, settings)) {
    std::vector<Segment> windows = segments;
    for (Segment& each : windows) each.count = settings.window;
    SegmentSimulation const start(model.compiled, experiments, windows, simulated(model, coefficients, settings));
    ShootingPoint point{Eigen::VectorXd(), model.starts(segments, guess)};
    fit_starts(start, point, noise_sd);
    runs_ = simulation_.residuals(point);
  }

  /// A channel in a row of a segment.
  double value(std::size_t segment, std::size_t channel, int row) const {
    return runs_[segment].residual(static_cast<int>(channel) * simulation_.rows_of_channel(static_cast<int>(segment)) + row);
  }

  /// Its error; nothing where it is not measured.
  std::optional<double> error(std::size_t segment, std::size_t channel, int row) const {
    Segment const& of = simulation_.segments()[segment];
    std::vector<double> const& samples = experiments_[static_cast<std::size_t>(of.experiment)].measured[channel];
    double const sample = samples.empty() ? std::nan("") : samples[static_cast<std::size_t>(of.first + row)];
    return std::isfinite(sample) ? std::optional(value(segment, channel, row) - sample) : std::nullopt;
  }

 private:
  static SegmentSimulation::Settings simulated(ValidatedModel const& model, Eigen::VectorXd const& coefficients,
                                               ForecastSettings const& settings) {
    SegmentSimulation::Settings out{{}, model.others, 0, settings.solver, settings.execution, settings.pool, model.centres};
    std::vector<int> const fitted = model.fitted();
    for (std::size_t j = 0; j < fitted.size(); ++j)
      out.others[static_cast<std::size_t>(fitted[j])] = coefficients(static_cast<Eigen::Index>(j));
    return out;
  }

  std::span<Experiment const> experiments_;
  SegmentSimulation simulation_;
  std::vector<SegmentSlopes> runs_;
};

/// Whether the `window` rows from `first` on hold half as many samples of each channel as such windows hold on average: a start may
/// be read off them.
bool shows_start(Experiment const& experiment, int first, int window) {
  for (std::vector<double> const& channel : experiment.measured) {
    auto const samples = [](auto from, auto to) {
      return static_cast<double>(std::count_if(from, to, [](double y) { return std::isfinite(y); }));
    };
    if (channel.empty()) continue;
    if (samples(channel.begin(), channel.end()) == 0) return false;
    double const average = samples(channel.begin(), channel.end()) * window / static_cast<double>(channel.size());
    if (samples(channel.begin() + first, channel.begin() + first + window) < average / 2) return false;
  }
  return true;
}

std::vector<double> sds_of(std::span<Experiment const> experiments, std::size_t channels) {
  std::vector<double> sds;
  for (std::size_t c = 0; c < channels; ++c) {
    double sum = 0, squares = 0, n = 0;
    for (Experiment const& each : experiments)
      for (double const y : each.measured[c])
        if (std::isfinite(y)) sum += y, ++n;
    for (Experiment const& each : experiments)
      for (double const y : each.measured[c])
        if (std::isfinite(y)) squares += (y - sum / n) * (y - sum / n);
    sds.push_back(n > 0 ? std::sqrt(squares / n) : 0);
  }
  return sds;
}

}  // namespace

ForecastErrors forecast_errors(ValidatedModel const& model, Eigen::VectorXd const& coefficients, std::span<double const> noise_sd,
                               std::span<Experiment const> experiments, StartGuess& guess, ForecastSettings const& settings) {
  std::size_t const channels = model.channels.size();
  int const window = settings.window, horizon = settings.horizon;
  std::vector<Segment> segments, whole;
  for (int e = 0; e < static_cast<int>(experiments.size()); ++e) {
    Experiment const& experiment = experiments[static_cast<std::size_t>(e)];
    int const rows = static_cast<int>(experiment.time.size());
    int const places = rows - window - horizon + 1, origins = std::min(places, settings.origins);
    for (int o = 0; o < origins; ++o) {
      int const first = origins == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(o) * (places - 1) / (origins - 1));
      if (shows_start(experiment, first, window)) segments.push_back({e, first, window + horizon});
    }
    int const last = rows - window;
    int begin = 0;
    while (begin < last && !shows_start(experiment, begin, window)) ++begin;
    if (begin < last) whole.push_back({e, begin, rows - begin});
  }
  ForecastErrors out;
  out.sd = sds_of(experiments, channels);
  std::vector<Mean> one(channels), far(channels), free(channels);
  auto const add = [](Mean& mean, std::optional<double> error) {
    if (error) mean.add(*error);
  };
  Forecasts const short_runs(model, coefficients, noise_sd, experiments, guess, settings, segments);
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (std::size_t c = 0; c < channels; ++c) {
      add(one[c], short_runs.error(s, c, window));
      add(far[c], short_runs.error(s, c, window + horizon - 1));
    }
  Forecasts const free_runs(model, coefficients, noise_sd, experiments, guess, settings, whole);
  for (std::size_t s = 0; s < whole.size(); ++s) {
    std::span<double const> const time = std::span(experiments[static_cast<std::size_t>(whole[s].experiment)].time)
                                             .subspan(static_cast<std::size_t>(whole[s].first));
    FreeMotion run{whole[s].experiment, whole[s].first, window, std::vector<std::vector<double>>(channels)};
    for (std::size_t c = 0; c < channels; ++c)
      for (int i = 0; i < whole[s].count; ++i) run.channels[c].push_back(free_runs.value(s, c, i));
    out.runs.push_back(std::move(run));
    bool followed = true;
    for (int i = window; i < whole[s].count; ++i)
      for (std::size_t c = 0; c < channels; ++c) {
        auto const error = free_runs.error(s, c, i);
        if (!error) continue;
        free[c].add(*error);
        if (s == 0 && followed && !(std::abs(*error) <= lost * out.sd[c])) {
          followed = false;
          out.follows = time[static_cast<std::size_t>(i)] - time[static_cast<std::size_t>(window - 1)];
        }
      }
    if (s == 0 && followed) out.follows = time.back() - time[static_cast<std::size_t>(window - 1)];
  }
  for (std::size_t c = 0; c < channels; ++c) {
    out.one_step.push_back(one[c].root());
    out.horizon.push_back(far[c].root());
    out.free_run.push_back(free[c].root());
  }
  return out;
}

int bounded_runs(ValidatedModel const& model, std::span<Experiment const> experiments, std::span<LaneArray const> points,
                 ForecastSettings const& settings) {
  if (points.empty()) return 0;
  std::vector<bool> bounded(static_cast<std::size_t>(points.front().width()), true);
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    Experiment const& experiment = experiments[e];
    int const rows = static_cast<int>(experiment.time.size()), count = static_cast<int>(model.channels.size());
    Simulator const simulator(model.centres, Schedule(*model.centres, experiment, settings.solver), settings.execution,
                              settings.pool);
    LaneArray out(rows * count, points[e].width());
    std::vector<Outcome> outcome(bounded.size());
    simulator.records(points[e], 0, rows, out, outcome);
    for (int r = 0; r < count; ++r) {
      Bounds const bounds(experiment.measured[static_cast<std::size_t>(r)]);
      for (int w = 0; w < out.width(); ++w)
        for (int i = 0; i < rows; ++i)
          if (auto const lane = static_cast<std::size_t>(w); !outcome[lane].ok || !bounds.hold(out(i * count + r, w)))
            bounded[lane] = false;
    }
  }
  return static_cast<int>(std::count(bounded.begin(), bounded.end(), true));
}

}  // namespace sysid
