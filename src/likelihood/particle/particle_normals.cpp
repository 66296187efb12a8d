// Numbers of one stream, many at a time.
#include "likelihood/particle/particle_normals.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/normals.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

std::span<double const> StreamNormals::take(std::size_t count) {
  numbers_.resize(count);
  if (count > 0) draw_normals({&stream_, 1}, Lanes(numbers_.data(), static_cast<int>(count), 1));
  return numbers_;
}

std::span<double const> StoredNormals::take(std::size_t count) {
  if (rest_.size() < count) throw InternalError("a filter takes more numbers than are stored");
  std::span<double const> const taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

void move_normals(std::span<double> numbers, double correlation, StreamKey key) {
  constexpr std::size_t at_once = 4096;
  StreamNormals fresh(key);
  double const rest = std::sqrt(1 - correlation * correlation);
  for (std::size_t from = 0; from < numbers.size(); from += at_once) {
    std::span<double const> const added = fresh.take(std::min(at_once, numbers.size() - from));
    for (std::size_t i = 0; i < added.size(); ++i) numbers[from + i] = correlation * numbers[from + i] + rest * added[i];
  }
}

}  // namespace sysid
