// Box and Muller over lanes.
#include "core/numeric/normals.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/numeric/elementary.hpp"

namespace sysid {

void draw_normals(std::span<Stream> streams, Lanes out) {
  // All pairs of rows together: of few streams a row alone would leave vectors unfilled.
  std::size_t const width = streams.size(), pairs = static_cast<std::size_t>(out.rows() + 1) / 2, count = pairs * width;
  std::vector<double> numbers(3 * count);
  double *const radius = numbers.data(), *const sine = radius + count, *const cosine = sine + count;
  for (std::size_t w = 0; w < width; ++w)
    for (std::size_t i = w; i < count; i += width) {
      radius[i] = streams[w].uniform();
      cosine[i] = 2 * std::numbers::pi * streams[w].uniform();
    }
  elementary::log_lanes(radius, radius, static_cast<int>(count));
  elementary::sin_lanes(cosine, sine, static_cast<int>(count));
  elementary::cos_lanes(cosine, cosine, static_cast<int>(count));
  for (int r = 0; r < out.rows(); ++r) {
    std::size_t const first = static_cast<std::size_t>(r / 2) * width;
    double const* const wave = r % 2 == 0 ? cosine : sine;
    for (std::size_t w = 0; w < width; ++w) out.row(r)[w] = std::sqrt(-2 * radius[first + w]) * wave[first + w];
  }
}

}  // namespace sysid
