// What the numbers of a column look like: its range, what is missing, what a sensor or a logger may have done to it.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sysid {

/// A peak of the spectrum: a sine of this frequency and about this amplitude.
struct SpectralPeak {
  double frequency = 0;  // Hz where times are seconds
  double amplitude = 0;
};

struct ColumnLook {
  std::string name;
  std::string unit;    // as the data block would state it; empty: not known
  std::string unread;  // why its numbers cannot be read; then nothing below is filled in
  std::size_t rows = 0, missing = 0;
  double first = 0, smallest = 0, largest = 0, mean = 0, sd = 0;
  bool dead = false;                              // one number in all rows
  std::size_t at_smallest = 0, at_largest = 0;    // samples in runs at an end of the range, as of a clipped signal; 0: no such runs
  std::size_t frozen_first = 0, frozen_last = 0;  // rows, from 1, in which the sensor seems to have frozen; 0: none
  double quantum = 0;                             // all numbers are whole multiples of it apart; 0: no such step is seen
  std::size_t levels = 0;                         // different numbers
  double drift = 0;                 // of a straight line from the first row to the last, where it exceeds the spread around it
  std::vector<SpectralPeak> peaks;  // the largest first; of equal steps without gaps
};

/// values: NaN where missing. step: between rows, where they are equal and all samples are there; else 0.
ColumnLook look_at_column(std::string name, std::vector<double> const& values, double step);

}  // namespace sysid
