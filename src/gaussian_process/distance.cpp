// Scaled distances between a point and a strip of others, and what they pass on to the derivatives in length-scales.
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {

void squared_distances(Strip const& strip, Numbers lengths, double* out) {
  for (int i = 0; i < strip.size; ++i) out[i] = 0;
  for (std::size_t d = 0; d < lengths.size(); ++d) {
    double const* const left = strip.left[d];
    double const right = strip.right[d], scale = 1 / lengths[d];
    for (int i = 0; i < strip.size; ++i) {
      double const u = (left[i] - right) * scale;
      out[i] += u * u;
    }
  }
}

Jet squared_distance(Jets left, Jets right, Jets lengths) {
  Jet sum;
  for (std::size_t d = 0; d < left.size(); ++d) {
    Jet const u = (left[d] - right[d]) / lengths[d];
    sum = sum + u * u;
  }
  return sum;
}

void add_length_gradient(Strip const& strip, Numbers lengths, double const* weights, double* gradient) {
  for (std::size_t d = 0; d < lengths.size(); ++d) {
    double const* const left = strip.left[d];
    double const right = strip.right[d], scale = 1 / lengths[d];
    double sum = 0;
    for (int i = 0; i < strip.size; ++i) {
      double const u = (left[i] - right) * scale;
      sum += weights[i] * u * u;
    }
    gradient[d] += sum;
  }
}

}  // namespace sysid::gaussian_process
