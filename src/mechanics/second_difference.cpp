// Local polynomials by least squares (Savitzky and Golay 1964).
#include "mechanics/second_difference.hpp"

#include <cmath>
#include <cstddef>

namespace sysid {

SecondDifference::SecondDifference(int half_width) {
  double const points = 2 * half_width + 1;
  double second = 0, fourth = 0;
  for (int k = -half_width; k <= half_width; ++k) second += k * k, fourth += 1.0 * k * k * k * k;
  double const squares = fourth - second * second / points;
  double sum = 0;
  for (int k = -half_width; k <= half_width; ++k) {
    weights.push_back(2 * (k * k - second / points) / squares);
    sum += weights.back() * weights.back();
  }
  noise = std::sqrt(sum);
  // s_(k+1) = w_k + 2 s_k - s_(k-1), beginning with nothing.
  double before = 0, now = 0;
  for (int k = 0; k + 2 < static_cast<int>(points); ++k) {
    double const next = weights[static_cast<std::size_t>(k)] + 2 * now - before;
    smoothing.push_back(next);
    before = now;
    now = next;
  }
}

Derivatives derivatives(std::vector<double> const& samples, int half_width, double step) {
  SecondDifference const difference(half_width);
  double const points = 2 * half_width + 1;
  double second = 0, fourth = 0, sixth = 0;
  for (int k = -half_width; k <= half_width; ++k) {
    double const square = 1.0 * k * k;
    second += square;
    fourth += square * square;
    sixth += square * square * square;
  }
  Derivatives out;
  for (int i = half_width; i + half_width < static_cast<int>(samples.size()); ++i) {
    double value = 0, slope = 0, curvature = 0;
    for (int k = -half_width; k <= half_width; ++k) {
      double const y = samples[static_cast<std::size_t>(i + k)];
      curvature += difference.weights[static_cast<std::size_t>(k + half_width)] * y;
      slope += k * (sixth - fourth * k * k) / (second * sixth - fourth * fourth) * y;
      value += (fourth - k * k * second) / (points * fourth - second * second) * y;
    }
    out.value.push_back(value);
    out.velocity.push_back(slope / step);
    out.acceleration.push_back(curvature / (step * step));
  }
  return out;
}

bool equidistant(std::vector<double> const& time) {
  for (std::size_t i = 2; i < time.size(); ++i)
    if (std::fabs(time[i] - time[i - 1] - (time[1] - time[0])) > 1e-6 * (time[1] - time[0])) return false;
  return time.size() > 2;
}

}  // namespace sysid
