// A record whose contents are not known yet: its columns, its time, and the data block that reads it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "data/cell/rounded_times.hpp"
#include "data/look/column_look.hpp"

namespace sysid {

struct TimeLook {
  std::string column;               // empty: no column has the time
  bool stamps = false;              // dates and times
  bool since_first = false;         // s since the first row, where the numbers count from a date
  std::string unit;                 // of its numbers
  bool assumed = false;             // neither the file nor a name states the unit
  bool by_steps = false;            // no name says that it is the time: its steps are equal
  double first = 0, last = 0;       // s
  double step = 0;                  // s: the mean, or where there are gaps the median
  std::size_t unequal = 0;          // steps that differ from the median by more than 0.1 %, gaps apart
  std::size_t gaps = 0;             // steps of more than one and a half medians
  double longest_gap = 0;           // s
  std::size_t longest_gap_row = 0;  // that it ends at, from 1
  std::optional<RoundedSteps> rounded;
};

/// A variable of the file that is no column of numbers.
struct UnreadVariable {
  std::string name, reason;  // "is an array of structs: ..."
};

struct RecordLook {
  std::string file, format;  // format: "text", "MATLAB file"
  std::size_t rows = 0;
  int lines_below = 0;                // the table, left out: a footer
  std::string reading;                // `read ...`, empty where the file is plain CSV
  std::string question;               // what may be read in two ways; the first way is shown
  std::vector<std::string> readings;  // the ways
  TimeLook time;
  std::vector<UnreadVariable> left_out;
  std::vector<ColumnLook> columns;          // in the order of the file
  std::vector<double> times;                // s; row numbers where no column has them
  std::vector<std::vector<double>> values;  // of the columns; empty where one cannot be read
  std::string block;                        // a data block ready to paste
};

/// IoError where the file cannot be read, UserError where it is no record.
RecordLook look_at_record(std::string const& path);

}  // namespace sysid
