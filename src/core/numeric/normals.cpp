// Box and Muller over lanes.
#include "core/numeric/normals.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/numeric/elementary.hpp"

namespace sysid {

void draw_normals(std::span<Stream> streams, Lanes out) {
  std::size_t const width = streams.size();
  std::vector<double> radius(width), sine(width), cosine(width);
  for (int r = 0; r < out.rows(); r += 2) {
    for (std::size_t w = 0; w < width; ++w) {
      radius[w] = streams[w].uniform();
      cosine[w] = 2 * std::numbers::pi * streams[w].uniform();
    }
    elementary::log_lanes(radius.data(), radius.data(), static_cast<int>(width));
    elementary::sin_lanes(cosine.data(), sine.data(), static_cast<int>(width));
    elementary::cos_lanes(cosine.data(), cosine.data(), static_cast<int>(width));
    for (std::size_t w = 0; w < width; ++w) {
      double const length = std::sqrt(-2 * radius[w]);
      out.row(r)[w] = length * cosine[w];
      if (r + 1 < out.rows()) out.row(r + 1)[w] = length * sine[w];
    }
  }
}

}  // namespace sysid
