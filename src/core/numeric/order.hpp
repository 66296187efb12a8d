// Sequences of numbers in order, each number with its place.
#pragma once
#include <cstdint>
#include <vector>

namespace sysid {

/// A number and where it stood.
struct Ranked {
  double value;
  std::uint32_t place;
};

/// Sorts by value, in a time proportional to their number; of equal ones the order stays; -0 stands before 0. None is NaN.
void sort_by_value(std::vector<Ranked>& all);
/// The same of numbers alone.
void sort_numbers(std::vector<double>& all);

}  // namespace sysid
