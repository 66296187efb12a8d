// Facts about channels and inputs, computed from their samples alone.
#include "regression/column/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/periodogram.hpp"
#include "regression/column/spectrum.hpp"

namespace sysid::regression {

int channel_of(Dictionary const& dictionary, int state, int order) {
  for (std::size_t c = 0; c < dictionary.channels.size(); ++c)
    if (dictionary.channels[c].state == state && dictionary.channels[c].order == order) return static_cast<int>(c);
  return -1;
}

int base_channel(Dictionary const& dictionary, int state, int order) {
  for (int base = order; base >= 0; --base)
    if (int const channel = channel_of(dictionary, state, base); channel >= 0) return channel;
  return -1;
}

Symbol const* symbol_of(Dictionary const& dictionary, NodeId leaf) {
  for (Symbol const& symbol : dictionary.symbols)
    if (symbol.leaf == leaf) return &symbol;
  return nullptr;
}

std::vector<Symbol> symbols_below(Dictionary const& dictionary, std::span<NodeId const> roots) {
  std::vector<NodeId> const below = dictionary.graph.reachable(roots);
  std::vector<Symbol> symbols;
  for (Symbol const& symbol : dictionary.symbols)
    if (std::find(below.begin(), below.end(), symbol.leaf) != below.end()) symbols.push_back(symbol);
  return symbols;
}

int derivatives_needed(Dictionary const& dictionary) {
  std::vector<NodeId> roots;
  for (Equation const& equation : dictionary.equations) {
    roots.push_back(equation.known);
    for (Term const& term : equation.terms) roots.push_back(term.expression);
  }
  int needed = 0;
  for (Symbol const& symbol : symbols_below(dictionary, roots)) {
    if (symbol.kind != Symbol::Kind::state) continue;
    int const channel = base_channel(dictionary, symbol.index, symbol.order);
    if (channel >= 0) needed = std::max(needed, symbol.order - dictionary.channels[static_cast<std::size_t>(channel)].order);
  }
  return needed;
}

std::string symbol_text(Dictionary const& dictionary, int state, int order) {
  return dictionary.states[static_cast<std::size_t>(state)] + std::string(static_cast<std::size_t>(order), '\'');
}

std::optional<double> uniform_step(Experiment const& experiment) {
  if (unequal_step(experiment.time) > 0) return std::nullopt;
  return mean_step(experiment.time);
}

namespace {

struct DifferenceSum {
  double squares = 0;
  std::size_t count = 0;

  void add(std::span<double const> samples, std::span<double const> relative = {}) {
    constexpr double weights[] = {1, -6, 15, -20, 15, -6, 1};
    for (std::size_t i = 0; i + 7 <= samples.size(); ++i) {
      double difference = 0, variance = relative.empty() ? 924 : 0;
      for (std::size_t k = 0; k < 7; ++k) difference += weights[k] * samples[i + k];
      for (std::size_t k = 0; k < 7 && !relative.empty(); ++k) variance += std::pow(weights[k] * relative[i + k], 2);
      if (!std::isfinite(difference)) continue;
      squares += difference * difference * (924 / variance);
      ++count;
    }
  }
  double sd() const { return count == 0 ? 0 : std::sqrt(squares / (924 * static_cast<double>(count))); }
};

}  // namespace

double estimated_noise(std::span<double const> samples) {
  DifferenceSum sum;
  sum.add(samples);
  return sum.sd();
}

double fastest_period(std::span<double const> samples, double step) {
  Spectrum const spectrum = spectrum_of(samples, step);
  double total = 0, sum = 0;
  for (double const power : spectrum.power) total += power;
  if (!(total > 0)) return std::numeric_limits<double>::infinity();
  std::size_t k = 0;
  while (k + 1 < spectrum.power.size() && (sum += spectrum.power[k]) < 0.95 * total) ++k;
  return spectrum.length / static_cast<double>(std::max<std::size_t>(k, 1));
}

namespace {

/// sd of white noise, where it is 1 relative to others, as the quietest band of the spectrum has it; infinite where there are too
/// few samples for bands.
double noise_of_quietest_band(std::span<double const> samples, std::span<double const> relative) {
  constexpr std::size_t most_bands = 16, least_bands = 4, least_of_band = 64;  // a band's power is known to a sixth
  Spectrum const of = spectrum_of(samples, 1);
  std::size_t const bins = of.power.empty() ? 0 : of.power.size() - 1, bands = std::min(most_bands, bins / least_of_band);
  double least = std::numeric_limits<double>::infinity();
  if (bands < least_bands) return least;
  std::size_t const width = bins / bands;
  for (std::size_t b = 0; b < bands; ++b) {
    double mean = 0;
    for (std::size_t k = 0; k < width; ++k) mean += of.power[1 + b * width + k] / static_cast<double>(width);
    least = std::min(least, mean);
  }
  double const sd = std::sqrt(least * static_cast<double>(of.size) / 2);
  if (relative.empty()) return sd;
  // The taper weights the middle of the record: of a motion that dies away it does not see the noise of the large samples.
  std::vector<double> weighted(relative.begin(), relative.end());
  taper(weighted);
  double squares = 0;
  for (double const each : weighted) squares += each * each;
  return sd / std::sqrt(squares / (1.5 * static_cast<double>(weighted.size())));
}

}  // namespace

double estimated_noise(std::span<ChannelSamples const> records) {
  DifferenceSum differences;
  double quietest = std::numeric_limits<double>::infinity();
  for (ChannelSamples const& each : records) {
    differences.add(each.samples, each.relative);
    if (each.equal_steps) quietest = std::min(quietest, noise_of_quietest_band(each.samples, each.relative));
  }
  // Differences take fast motion for noise. The least of noisy estimates is low itself, so it must be far below to count.
  return quietest < differences.sd() / 2 ? quietest : differences.sd();
}

std::vector<double> noise_of_channels(Dictionary const& dictionary, std::span<Experiment const> experiments) {
  std::vector<double> sds;
  for (std::size_t c = 0; c < dictionary.channels.size(); ++c) {
    std::vector<ChannelSamples> records;
    double squares = 0;
    std::size_t count = 0;
    for (Experiment const& experiment : experiments) {
      std::vector<double> const& samples = experiment.measured[c];
      records.push_back({samples});
      for (double const value : samples)
        if (std::isfinite(value)) squares += value * value, ++count;
    }
    double const rms = count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
    double const sd = dictionary.channels[c].noise_sd.value_or(estimated_noise(records));
    double const least = std::max(1e-9 * rms, std::numeric_limits<double>::min());
    sds.push_back(std::max(sd, least));
  }
  return sds;
}

namespace {

/// sd of the white noise that a channel consists of, where it is nothing else: neighbours differ as independent samples do, and no
/// band of the spectrum is quiet. Nothing where something moves.
std::optional<double> nothing_but_noise(std::span<Experiment const> experiments, std::size_t channel) {
  constexpr double of_sd = 0.8, of_band = 0.5;
  DifferenceSum differences;
  double squares = 0, quietest = std::numeric_limits<double>::infinity();
  std::size_t count = 0;
  for (Experiment const& experiment : experiments) {
    std::vector<double> const& samples = experiment.measured[channel];
    differences.add(samples);
    quietest = std::min(quietest, noise_of_quietest_band(samples, {}));
    double sum = 0, squared = 0;
    std::size_t finite = 0;
    for (double const value : samples)
      if (std::isfinite(value)) sum += value, ++finite;
    double const mean = finite == 0 ? 0 : sum / static_cast<double>(finite);
    for (double const value : samples)
      if (std::isfinite(value)) squared += (value - mean) * (value - mean);
    squares += squared;
    count += finite;
  }
  double const sd = count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
  if (!(sd > 0) || std::isinf(quietest) || differences.sd() < of_sd * sd || quietest < of_band * sd) return std::nullopt;
  return differences.sd();
}

}  // namespace

Concerns channel_concerns(Dictionary const& dictionary, std::span<Experiment const> experiments, std::span<int const> used) {
  Concerns concerns;
  for (int const channel : used) {
    auto const c = static_cast<std::size_t>(channel);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Experiment const& experiment : experiments)
      for (std::size_t i = 0; i < experiment.measured[c].size(); ++i)
        if (std::isfinite(experiment.measured[c][i])) {
          low = std::min(low, experiment.measured[c][i]);
          high = std::max(high, experiment.measured[c][i]);
        }
    std::string const& name = dictionary.channels[c].name;
    if (low > high) {
      Concern concern{.kind = Concern::Kind::not_measured, .channel = channel};
      concern.clause = fmt::format("`{}` has no samples", name);
      concerns.push_back(std::move(concern));
    } else if (low == high) {
      Concern concern{.kind = Concern::Kind::at_rest, .channel = channel, .value = low};
      concern.clause =
          fmt::format("`{}` is {:.4g} on the whole record: a system at rest gives no information about its equation", name, low);
      concerns.push_back(std::move(concern));
    }
  }
  return concerns;
}

Concerns record_concerns(Dictionary const& dictionary, std::span<Experiment const> experiments, std::span<int const> used) {
  Concerns concerns;
  for (Experiment const& experiment : experiments)
    if (!uniform_step(experiment)) {
      Concern concern{.kind = Concern::Kind::unequal_steps};
      std::vector<double> const& time = experiment.time;
      std::size_t const i = unequal_step(time);
      concern.clause =
          fmt::format("the time steps of `{}` are unequal: row {} is {:.6g} s after the row before, the mean step is {:.6g} s",
                      experiment.name, experiment.first_row + static_cast<int>(i), time[i] - time[i - 1], mean_step(time));
      concerns.push_back(std::move(concern));
    }
  Concerns const of_channels = channel_concerns(dictionary, experiments, used);
  concerns.insert(concerns.end(), of_channels.begin(), of_channels.end());
  for (int const channel : used) {
    auto const c = static_cast<std::size_t>(channel);
    bool const said =
        std::any_of(of_channels.begin(), of_channels.end(), [&](Concern const& each) { return each.channel == channel; });
    if (said || dictionary.channels[c].order > 0 || dictionary.channels[c].noise_sd) continue;
    if (!nothing_but_noise(experiments, c)) continue;
    Concern concern{.kind = Concern::Kind::at_rest, .channel = channel};
    concern.clause =
        fmt::format("`{}` contains only white noise in this record: its spectrum is flat", dictionary.channels[c].name);
    concerns.push_back(std::move(concern));
  }
  return concerns;
}

bool usable(Experiment const& experiment, std::span<int const> used, int row) {
  auto const i = static_cast<std::size_t>(row);
  if (!experiment.scored.empty() && experiment.scored[i] == 0) return false;
  return std::all_of(used.begin(), used.end(),
                     [&](int channel) { return std::isfinite(experiment.measured[static_cast<std::size_t>(channel)][i]); });
}

InputSides input_sides(InputSignal const& signal, int order) {
  InputSides sides;
  int const rows = signal.rows();
  auto const read = [&](int interval, double s) { return order == 0 ? signal.value(interval, s) : signal.rate(interval, s); };
  for (int i = 0; i < rows; ++i) {
    sides.before.push_back(i > 0 ? read(i - 1, 1) : read(0, 0));
    sides.after.push_back(i + 1 < rows ? read(i, 0) : read(rows - 2, 1));
  }
  return sides;
}

}  // namespace sysid::regression
