// Box and Muller over lanes.
#include "core/numeric/normals.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/numeric/elementary.hpp"

namespace sysid {

void draw_normals(std::span<Stream> streams, Lanes out) {
  // All pairs of rows together: of few streams a row alone would leave vectors unfilled.
  auto const rows = static_cast<std::size_t>(out.rows());
  std::size_t const width = streams.size(), pairs = (rows + 1) / 2, count = pairs * width;
  std::vector<double> numbers(3 * count + 2 * pairs);
  double *const radius = numbers.data(), *const sine = radius + count, *const cosine = sine + count, *const own = cosine + count;
  for (std::size_t w = 0; w < width; ++w) {
    streams[w].uniforms({own, 2 * pairs});
    for (std::size_t pair = 0, i = w; pair < pairs; ++pair, i += width) {
      radius[i] = own[2 * pair];
      cosine[i] = 2 * std::numbers::pi * own[2 * pair + 1];
    }
  }
  elementary::log_lanes(radius, radius, static_cast<int>(count));
  elementary::sin_lanes(cosine, sine, static_cast<int>(count));
  elementary::cos_lanes(cosine, cosine, static_cast<int>(count));
  for (std::size_t i = 0; i < count; ++i) radius[i] = std::sqrt(-2 * radius[i]);
  if (width == 1 && rows > 1) {
    double* to = out.row(0).data();
    std::ptrdiff_t const step = out.row(1).data() - to;
    for (std::size_t pair = 0; pair < rows / 2; ++pair, to += 2 * step) {
      to[0] = radius[pair] * cosine[pair];
      to[step] = radius[pair] * sine[pair];
    }
    if (rows % 2 == 1) *to = radius[pairs - 1] * cosine[pairs - 1];
    return;
  }
  for (std::size_t r = 0; r < rows; ++r) {
    std::size_t const first = r / 2 * width;
    double const* const wave = r % 2 == 0 ? cosine : sine;
    double* const to = out.row(static_cast<int>(r)).data();
    for (std::size_t w = 0; w < width; ++w) to[w] = radius[first + w] * wave[first + w];
  }
}

}  // namespace sysid
