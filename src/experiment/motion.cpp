// Root mean squares of a channel and of its divided differences.
#include "experiment/motion.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {

Motion motion_of(std::vector<ExperimentData> const& data, std::size_t channel, int orders) {
  Motion motion;
  motion.size.assign(static_cast<std::size_t>(orders) + 1, 0);
  double mean_first = 0;
  for (ExperimentData const& each : data) {
    std::vector<double> const& time = each.experiment.time;
    std::vector<double> values, times;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (!std::isnan(each.experiment.measured[channel][i])) {
        values.push_back(each.experiment.measured[channel][i]);
        times.push_back(time[i]);
      }
    if (values.empty()) continue;
    mean_first += values.front() / static_cast<double>(data.size());
    double mean = 0;
    for (double const v : values) mean += v / static_cast<double>(values.size());
    for (int k = 0; k <= orders && values.size() > 1; ++k) {
      double square = 0;
      for (double const v : values) square += (v - (k == 0 ? mean : 0)) * (v - (k == 0 ? mean : 0));
      double& size = motion.size[static_cast<std::size_t>(k)];
      size = std::max(size, std::sqrt(square / static_cast<double>(values.size())));
      for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
      values.pop_back();
      times.pop_back();
    }
  }
  motion.first = mean_first;
  return motion;
}

}  // namespace sysid
