// Counting and weighing.
#include "inference/abc/population.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sysid::abc {
void Particles::add(ConstLanes x, int lane, double log_prior_there, double distance_there) {
  for (int d = 0; d < x.rows(); ++d) at.push_back(x(d, lane));
  log_prior.push_back(log_prior_there);
  distance.push_back(distance_there);
  weight.push_back(0);
}

LaneArray Particles::lanes(int dimension) const {
  LaneArray result(dimension, count());
  for (int j = 0; j < count(); ++j)
    for (int d = 0; d < dimension; ++d) result(d, j) = at[static_cast<std::size_t>(j * dimension + d)];
  return result;
}

double Particles::weight_sum() const { return std::accumulate(weight.begin(), weight.end(), 0.0); }

int Population::accepted() const {
  int total = 0;
  for (Particles const& each : models) total += each.count();
  return total;
}

double Population::ess() const {
  double squares = 0;
  for (Particles const& each : models)
    for (double const w : each.weight) squares += w * w;
  return 1 / squares;
}

double Population::quantile(double part) const {
  std::vector<double> all;
  for (Particles const& each : models) all.insert(all.end(), each.distance.begin(), each.distance.end());
  std::sort(all.begin(), all.end());
  auto const rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(all.size()) * (1 - 1e-12)));  // 0.07 x 100 is 7
  return all[std::clamp<std::size_t>(rank, 1, all.size()) - 1];
}

}  // namespace sysid::abc
