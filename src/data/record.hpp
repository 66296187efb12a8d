// A data file as the model sees it: time, inputs and measured channels in coherent SI units.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/numeric/unit.hpp"
#include "core/text/diagnostic.hpp"
#include "data/cell/rounded_times.hpp"
#include "data/experiment.hpp"
#include "data/table/reading_rules.hpp"
#include "data/unused_time.hpp"

namespace sysid {

/// A column and how its numbers become those of the model: converted from `unit` to `declared`, offsets applied, then scaled to SI.
/// With one of the two given the numbers are in that unit; with neither they stay as they are. Dimensions agree (the checker has
/// seen to it).
struct ColumnRequest {
  std::string column;
  std::optional<Unit> unit;      // after the column in the data block
  std::optional<Unit> declared;  // in the model
  std::optional<Span> mention;   // where messages point to
  bool counts = false;           // whole numbers >= 0 are expected
};

struct InputRequest : ColumnRequest {
  InputRule rule = InputRule::zero_order;
};

struct RecordRequest {
  std::string path;
  std::optional<Span> mention;
  ReadingRules rules{};                                // how the file is written
  std::optional<ColumnRequest> time;                   // in seconds unless it has a unit
  double step = 0;                                     // [s] > 0 when there is no time column; row 1 is then at time 0
  bool independent_rows = false;                       // no dynamics: times in any order, and row numbers where there are none
  bool uses_times = true;                              // independent rows: whether the model reads their times
  std::vector<InputRequest> inputs;                    // in the order of the model's inputs
  std::vector<std::optional<ColumnRequest>> measured;  // in the order of its channels; nothing: not in this data
  std::string shown_path{};                            // what messages name in place of the path; empty: the path
};

/// A column whose name ends in another unit of the same kind than that in which its numbers were read; or of the time, whose whole
/// name is one.
struct UnitInName {
  std::string column;
  std::string in_name, read_in;
  bool stated = false;   // the data block has it so
  bool cycles = false;   // one counts cycles and the other radians
  bool word = false;     // `time hours`
  bool of_file = false;  // the unit that the file states, of another kind of quantity
};

/// Rows without a value of an input. The input bridges them by a straight line, which no run may use.
struct InputGap {
  std::size_t input = 0;    // its index
  int first = 0, last = 0;  // rows
  int line = 0;             // of the first, in the file; 0: a file without lines
  std::string column;
  double before = 0, after = 0;  // the numbers around it, as the file has them; NaN at an end of the record
  std::optional<Span> mention;
};

struct Record {
  std::string path;
  std::string digest;                         // SHA-256 of the file
  std::vector<double> time;                   // [N] s, strictly increasing, N >= 2
  std::optional<Unit> time_unit;              // in which people read them; absent: seconds
  std::vector<InputSignal> inputs;            // over the whole record
  std::vector<InputGap> gaps;                 // of inputs, those of one input in the order of rows
  bool independent_rows = false;              // as it was asked for
  std::vector<std::vector<double>> measured;  // [N] each, NaN where missing; empty: not in this data
  std::vector<std::string> comments;          // before the header of the file
  std::vector<UnitInName> other_units;
  std::vector<std::pair<std::string, Unit>> file_units;  // of columns whose numbers were read in the unit that the file states
  std::optional<RoundedSteps> rounded;                   // of times that are read as they stand
  std::optional<UnusedTime> unused_time;
  std::string measured_time;                // a measured column that is called and looks like the time; empty: none
  std::vector<std::string> unused_columns;  // of the file

  int rows() const { return static_cast<int>(time.size()); }
};

/// Reads the file and everything asked for. What is wrong with it is added to `diagnostics`, one message per column at most;
/// nothing is returned then. IoError when the file cannot be read. Times that are equal steps before they were rounded are read as
/// such (data/cell/rounded_times.hpp).
std::optional<Record> load(RecordRequest const& request, Diagnostics& diagnostics);

/// Rows of a record from 1, both included; last = 0 means its last row.
struct RowRange {
  int first = 1;
  int last = 0;
};

}  // namespace sysid
