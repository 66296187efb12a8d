// Samples that do not belong: found where they are few, whatever they have done to the estimated noise, and nowhere else.
#include "diagnostics/residuals/outliers.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

std::vector<double> noise_of(std::uint64_t seed, std::size_t count, double sd = 1) {
  Stream stream({seed, Purpose::test, 0, 0});
  std::vector<double> values(count);
  for (double& value : values) value = sd * stream.normal();
  return values;
}

}  // namespace

TEST_CASE("normal residuals have no outliers, of whatever size they are") {
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    for (double const sd : {0.3, 1.0, 2.2, 40.0}) CHECK(outliers(noise_of(seed, 300, sd)).empty());
}

TEST_CASE("a spike is found, also where it has made the estimated noise large") {
  for (double const sd : {1.0, 1.0 / 17}) {
    std::vector<double> residuals = noise_of(1, 300, sd);
    residuals[150] = 17;
    residuals[7] = std::nan("");
    CHECK(outliers(residuals) == std::vector<std::size_t>{150});
  }
}

TEST_CASE("many far samples are no outliers, and few samples show none") {
  std::vector<double> many = noise_of(1, 300);
  for (std::size_t i = 0; i < 4; ++i) many[50 * i] = 20;
  CHECK(outliers(many).empty());
  many[0] = 0;
  CHECK(outliers(many).size() == 3);
  std::vector<double> few = noise_of(1, 19);
  few[3] = 100;
  CHECK(outliers(few).empty());
}
