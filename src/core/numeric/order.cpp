// Sorting by the digits of the numbers, the last one first.                    Knuth 1998, vol. 3, sec. 5.2.5, algorithm R
#include "core/numeric/order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace sysid {
namespace {

constexpr int digits = 8;
constexpr std::size_t radix = 256;

/// Rises with the value: negative numbers have all bits turned round, the others their sign.
std::uint64_t bits_in_order(double value) {
  auto const bits = std::bit_cast<std::uint64_t>(value);
  return bits >> 63 != 0 ? ~bits : bits | std::uint64_t{1} << 63;
}

std::size_t digit(double value, int place) { return bits_in_order(value) >> (8 * place) & (radix - 1); }

double value_of(double number) { return number; }
double value_of(Ranked const& ranked) { return ranked.value; }

template <class Item>
void sort_by_digits(std::vector<Item>& all) {
  std::array<std::array<std::size_t, radix>, digits> counts{};
  for (Item const& each : all)
    for (int d = 0; d < digits; ++d) ++counts[static_cast<std::size_t>(d)][digit(value_of(each), d)];
  std::vector<Item> sorted(all.size());
  for (int d = 0; d < digits; ++d) {
    auto& begin = counts[static_cast<std::size_t>(d)];  // of each digit's numbers in `sorted`, once the counts are summed
    if (all.empty() || begin[digit(value_of(all.front()), d)] == all.size()) continue;  // all have the same
    std::size_t sum = 0;
    for (std::size_t& each : begin) {
      std::size_t const count = each;
      each = sum;
      sum += count;
    }
    for (Item const& each : all) sorted[begin[digit(value_of(each), d)]++] = each;
    all.swap(sorted);
  }
}

}  // namespace

void sort_by_value(std::vector<Ranked>& all) { sort_by_digits(all); }

void sort_numbers(std::vector<double>& all) {
  constexpr std::size_t few = 500;  // sorted sooner by comparisons
  if (all.size() < few)
    std::sort(all.begin(), all.end());
  else
    sort_by_digits(all);
}

}  // namespace sysid
