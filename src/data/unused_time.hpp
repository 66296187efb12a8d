// A column with times in a file whose data block says by `rate` or `step` when its rows were taken: the two must agree.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sysid {

class RecordFile;
struct RecordRequest;

/// What a column says of rows that are read at equal steps; nothing where it says the same. One of:
struct UnusedTime {
  enum class Kind {
    other_rate,   // equal steps of another length
    gap,          // the steps of the block, and at least one that is much longer
    unequal,      // no equal steps
    other_units,  // the steps of the block if its numbers, of which no unit is known, are no seconds
    by_steps      // equal steps of another length in a column that no name calls the time
  };
  Kind kind = Kind::other_rate;
  std::string column;
  std::string lines;    // that read it in the data block: `time t [ms]`
  double step = 0;      // s, the usual one
  double shortest = 0;  // s
  double longest = 0;   // s
  std::size_t row = 0;  // of the file, before the longest, from 1
  std::size_t gaps = 0;
  std::string meant_unit{};  // of `other_units`
};

/// Columns that `sysid data` would call the time: of a usual name or with dates and times of day, and where there is none of these
/// the only one of equal steps. Times that are measured are left out. Rounded times agree with the steps that give them when they
/// are rounded, and so do those whose steps are all within a tenth of them.
std::optional<UnusedTime> find_unused_time(RecordFile const& file, RecordRequest const& request);

/// A column that is measured in no unit of time, though it is called after the time and its steps are equal; empty: none.
std::string find_measured_time(RecordFile const& file, RecordRequest const& request);

/// In the order of the file.
std::vector<std::string> find_unused_columns(RecordFile const& file, RecordRequest const& request);

}  // namespace sysid
