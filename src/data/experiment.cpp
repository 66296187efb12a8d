// Parts of an experiment.
#include "data/experiment.hpp"

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

}  // namespace sysid
