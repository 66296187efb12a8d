// Zeros of a lost transmission among those of a signal.
#include "data/cell/dropped_samples.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

std::vector<double> sine(double step, double noise, double offset = 0) {
  std::vector<double> values(400);
  Stream stream({1, Purpose::test, 0, 0});
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = offset + elementary::sin(step * static_cast<double>(i)) + noise * stream.normal();
  return values;
}

std::vector<double> without(std::vector<double> values, std::vector<std::size_t> const& rows) {
  for (std::size_t const row : rows) values[row] = 0;
  return values;
}

}  // namespace

TEST_CASE("zeros far from their neighbours are lost samples, in a slow signal, an offset and in noise") {
  std::vector<std::size_t> const rows = {17, 60, 61, 142, 143, 144, 250, 333};
  CHECK(dropped_samples(without(sine(0.1, 0), rows)) == std::vector<std::size_t>{0, 17, 60, 61, 142, 143, 144, 250, 333});
  CHECK(dropped_samples(without(sine(0.1, 0.05), rows)) == rows);
  CHECK(dropped_samples(without(sine(0.5, 0.02), rows)) == rows);
  CHECK(dropped_samples(without(sine(2, 0.1, 20), rows)) == rows);
  std::vector<double> missing = without(sine(0.1, 0.05, 3), rows);
  missing[100] = std::numeric_limits<double>::quiet_NaN();
  CHECK(dropped_samples(missing) == rows);
}

TEST_CASE("zeros of the signal are none: near others, rare, many, in long runs, or of a switch") {
  CHECK(dropped_samples(sine(0.1, 0.05)).empty());
  CHECK(dropped_samples(without(sine(0.1, 0.05, 3), {17, 60})).empty());
  std::vector<double> coarse = sine(0.1, 0.02);  // of a converter whose middle step is zero
  for (double& value : coarse) value = std::round(value * 20) / 20;
  CHECK(dropped_samples(coarse).empty());
  std::vector<double> noise = sine(0, 1);  // a zero is nowhere far from what is as rough
  for (std::size_t i = 0; i < 40; ++i) noise[10 * i + 3] = 0;
  CHECK(dropped_samples(noise).empty());
  std::vector<double> halves = sine(0.1, 0);  // a rectifier
  for (double& value : halves) value = std::fmax(value, 0);
  CHECK(dropped_samples(halves).empty());
  std::vector<double> corners, angle;
  for (int i = 0; i < 400; ++i) {
    corners.push_back(i % 40 == 0 ? 0 : std::fabs(elementary::sin(std::numbers::pi * i / 40)));
    angle.push_back(5.0 * i - 360 * std::floor(5.0 * i / 360));
  }
  CHECK(dropped_samples(corners).empty());
  CHECK(dropped_samples(angle).empty());
  std::vector<double> gaps = sine(0.1, 0, 5);
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (i % 100 < 10) gaps[i] = 0;
  CHECK(dropped_samples(gaps).empty());
  std::vector<double> switched(400, 0.7);
  for (std::size_t i = 0; i < switched.size(); i += 9) switched[i] = 0;
  CHECK(dropped_samples(switched).empty());
}
