// Moments of the squared deviance residual, over the quantiles of the noise.
#include "distribution/deviance.hpp"

#include <algorithm>
#include <vector>

namespace sysid {

///   E D^m = integral over probabilities q of D(Q(q))^m,   q = t^3 (10 - 15 t + 6 t^2): the midpoint rule over t, where the
///   logarithms by which D grows at either end are multiplied by what vanishes there.
DevianceMoments deviance_moments(DistributionRow const& noise, std::span<double const> arguments) {
  constexpr int count = 200;
  double first = 0, second = 0;
  for (int i = 0; i < count; ++i) {
    double const t = (i + 0.5) / count, rest = 1 - t, nearer = std::min(t, rest);
    double const tail = nearer * nearer * nearer * (10 - nearer * (15 - 6 * nearer));
    double const x = noise.quantile(tail, t < 0.5 ? Tail::lower : Tail::upper, arguments);
    Graph graph;
    std::vector<NodeId> given;
    for (double const argument : arguments) given.push_back(graph.constant(argument));
    NodeId const at = graph.constant(x);
    double const highest = graph.constant_value(noise.saturated(graph, at, given)).value();
    double const deviance = 2 * (highest - graph.constant_value(noise.log_density(graph, at, given)).value());
    double const weight = 30 * t * t * rest * rest / count;
    first += weight * deviance;
    second += weight * deviance * deviance;
  }
  return {first, second - first * first};
}

}  // namespace sysid
