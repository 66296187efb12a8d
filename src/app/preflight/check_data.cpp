// What a record holds for a task: rows, gaps, rate, and where the power of its inputs lies.
#include <algorithm>
#include <bit>
#include <cmath>

#include "app/preflight/check_file.hpp"
#include "core/numeric/fourier.hpp"

namespace sysid {
namespace {

constexpr double excluded_share = 0.005;  // of the power, at either end of the band

// The band that holds all but a share of the power at either end, from a periodogram of the samples less their mean.
void fill_band(InputSignal const& signal, double rate, CoveragePage::Input& input) {
  auto const rows = static_cast<std::size_t>(signal.rows());
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < rows; ++i) mean += signal.sample(static_cast<int>(i)) / static_cast<double>(rows);
  std::size_t const size = std::max<std::size_t>(4, std::bit_ceil(rows));
  Fourier::Parts re(size, 0.0), im(size, 0.0);
  int const bits = std::countr_zero(size);
  for (std::size_t i = 0; i < rows; ++i) {
    std::size_t reversed = 0;
    for (int b = 0; b < bits; ++b) reversed |= ((i >> b) & 1U) << (bits - 1 - b);
    double const value = signal.sample(static_cast<int>(i)) - mean;
    re[reversed] = value;
    square += value * value;
  }
  input.constant = !(square > 1e-20 * mean * mean * static_cast<double>(rows));
  if (input.constant) return;
  Fourier(size).from_reversed(re, im);
  std::vector<double> power(size / 2 + 1);
  double total = 0;
  for (std::size_t k = 0; k < power.size(); ++k) total += power[k] = re[k] * re[k] + im[k] * im[k];
  double sum = 0;
  bool begun = false;
  for (std::size_t k = 0; k < power.size(); ++k) {
    sum += power[k];
    double const frequency = rate * static_cast<double>(k) / static_cast<double>(size);
    if (!begun && sum > excluded_share * total) begun = true, input.low = frequency;
    input.high = frequency;
    if (sum >= (1 - excluded_share) * total) break;
  }
}

}  // namespace

CoveragePage describe_coverage(ExperimentData const& data, DataBlock const& block, StartRule start, Model const& model) {
  Experiment const& experiment = data.experiment;
  CoveragePage page;
  page.name = experiment.name;
  page.file = block.path;
  page.rows = data.record.rows();
  auto const first = std::find(experiment.scored.begin(), experiment.scored.end(), 1);
  page.first = experiment.first_row + static_cast<int>(first - experiment.scored.begin());
  page.last = experiment.first_row + static_cast<int>(experiment.scored.size()) - 1;
  page.scored = static_cast<int>(std::count(experiment.scored.begin(), experiment.scored.end(), 1));
  page.start_rows = start.kind == StartRule::Kind::estimated ? start.rows : 0;
  std::vector<double> const& time = experiment.time;
  double shortest = time.back() - time.front(), longest = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    shortest = std::min(shortest, time[i] - time[i - 1]);
    longest = std::max(longest, time[i] - time[i - 1]);
  }
  page.rate = static_cast<double>(time.size() - 1) / (time.back() - time.front());
  page.equal = longest - shortest <= 1e-3 * shortest;
  if (experiment.time_unit) {
    page.time_unit = experiment.time_unit->text;
    page.time_scale = experiment.time_unit->scale;
  }
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    CoveragePage::Input input;
    input.name = model.inputs[i].name;
    input.unit = model.inputs[i].unit_text();
    if (model.dynamics == Dynamics::continuous) input.rule = rule_name(experiment.inputs[i].rule());
    fill_band(experiment.inputs[i], page.rate, input);
    page.inputs.push_back(std::move(input));
  }
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    CoveragePage::Channel channel;
    channel.name = model.channels[c].name;
    channel.unit = model.channels[c].unit_text();
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
      if (experiment.scored[i] == 0) continue;
      double const value = experiment.measured[c][i];
      ++(std::isnan(value) ? channel.missing : channel.measured);
      if (std::isnan(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    if (channel.measured > 0) channel.range = model.channels[c].from_si(most - least);
    page.channels.push_back(std::move(channel));
  }
  return page;
}

}  // namespace sysid
