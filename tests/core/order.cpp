// Sorting by digits against sorting by comparison.
#include "core/numeric/order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

void check_order(std::vector<double> const& values) {
  std::vector<Ranked> by_digits, by_comparison;
  for (double const value : values) by_digits.push_back({value, static_cast<std::uint32_t>(by_digits.size())});
  by_comparison = by_digits;
  sort_by_value(by_digits);
  std::stable_sort(by_comparison.begin(), by_comparison.end(), [](Ranked a, Ranked b) { return a.value < b.value; });
  REQUIRE(by_digits.size() == values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK(by_digits[i].value == by_comparison[i].value);
    CHECK(by_digits[i].place == by_comparison[i].place);
  }
  std::vector<double> numbers = values, sorted = values;
  sort_numbers(numbers);
  std::sort(sorted.begin(), sorted.end());
  CHECK(numbers == sorted);
}

}  // namespace

TEST_CASE("numbers are in the order of their values, equal ones in the order of their places") {
  constexpr double infinity = std::numeric_limits<double>::infinity(), smallest = std::numeric_limits<double>::denorm_min();
  check_order({});
  check_order({3});
  check_order({2, 2, 2});
  check_order({infinity, 1, -infinity, 0, smallest, -smallest, -1, 1e300, -1e300, 1, 0.5, -1, infinity});
  Stream stream({4, Purpose::test, 0, 0});
  std::vector<double> wide, ties;
  for (int i = 0; i < 3000; ++i) {
    wide.push_back(std::ldexp(stream.normal(), static_cast<int>(stream.below(2000)) - 1000));
    ties.push_back(std::round(4 * stream.normal()) + 0.25);
  }
  check_order(wide);
  check_order(ties);
}
