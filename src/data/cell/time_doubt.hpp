// Numbers of a time column that are taken for seconds and seem to be something else than a count from a date: times of day written
// in digits, numbers of rows.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct ClockDoubt {
  std::vector<std::string> patterns;  // of `stamp`, that may be meant: `hhmmss.f`, `hhmm`; empty: there is no doubt
  std::size_t place = 0;              // the number that shows it, beside the one before
};

/// 115958, 115959, 120000: as times of day the steps are alike, as numbers they jump by 40 at a minute (or an hour of `hhmm`) and
/// by 4040 at an hour, and no number has 60 or more in the places of minutes and seconds. Numbers of seconds at equal steps never
/// are such. even_steps: doubts numbers from 10000 on that rise by whole hundreds as well, which have no jump that would show it.
ClockDoubt seems_clock(std::vector<double> const& values, bool even_steps);

/// Rises by one from row to row, and is called after that: `RECORD`, `Sample No`.
bool counts_rows(std::vector<double> const& values, std::string_view column);

}  // namespace sysid
