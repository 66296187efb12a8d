// Parts of an experiment.
#include "data/experiment.hpp"

#include <cmath>
#include <type_traits>

namespace sysid {

Experiment slice(Experiment const& experiment, int begin, int end, int lags) {
  Experiment part;
  part.name = experiment.name;
  part.time_unit = experiment.time_unit;
  part.first_row = experiment.first_row + begin;
  auto const cut = [&](auto const& values) {
    return values.empty() ? values : std::decay_t<decltype(values)>(values.begin() + begin, values.begin() + end);
  };
  part.time = cut(experiment.time);
  for (InputSignal const& input : experiment.inputs) part.inputs.push_back(input.view(begin, end - begin));
  for (std::size_t c = 0; c < experiment.measured.size(); ++c) {
    part.measured.push_back(cut(experiment.measured[c]));
    std::vector<double> before;
    for (int back = 1; back <= lags; ++back) before.push_back(measured_sample(experiment, static_cast<int>(c), begin - back));
    if (lags > 0) part.history.push_back(std::move(before));
  }
  if (lags == 0 && begin == 0) part.history = experiment.history;
  part.scored = cut(experiment.scored);
  part.corrects = cut(experiment.corrects);
  for (auto const& flags : experiment.has_lags) part.has_lags.push_back(cut(flags));
  return part;
}

double measured_sample(Experiment const& experiment, int channel, int row) {
  auto const c = static_cast<std::size_t>(channel);
  std::vector<double> const& measured = experiment.measured[c];
  double const missing = std::nan("");
  if (row >= 0) return measured.empty() ? missing : measured[static_cast<std::size_t>(row)];
  auto const back = static_cast<std::size_t>(-row - 1);
  return c < experiment.history.size() && back < experiment.history[c].size() ? experiment.history[c][back] : missing;
}

}  // namespace sysid
