// Errors of the times of a data file (E40). One named constructor per mistake.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "data/table/error_parts.hpp"

namespace sysid::data_errors {

/// E4010: a date or a time of day below numbers.
Diagnostic stamp_among_numbers(Cell const& cell, std::string_view text, Mention mention);
/// E4010: `0.01 s` in a column of times that is read without `stamp`.
Diagnostic durations(Cell const& cell, std::string_view text, Mention mention);
/// word: what `stamp` would say of them. is_text: `read` can be said of the file.
Diagnostic times_are_dates(Cell const& cell, double value, std::string_view word, bool is_text, Mention mention);
/// `115958, 115959, 120000`: a time of day as one number. patterns: of `stamp`, those that may be meant.
Diagnostic times_are_clock(Cell const& cell, double before, double now, std::vector<std::string> const& patterns, bool is_text,
                           Mention mention);
Diagnostic times_are_counts(Cell const& cell, Mention mention);
/// E4024. has_zone: the cell, and not the first one; or the other way about.
Diagnostic zones_differ(Cell const& cell, std::string_view text, bool has_zone, Mention mention);
/// E4024. `10:00:00:7` below `10:00:00:07`.
Diagnostic fractions_differ(Cell const& cell, std::string_view text, Mention mention);
/// E4024. text: empty where it may not be shown.
Diagnostic not_a_stamp(Cell const& cell, std::string_view text, std::string const& pattern, Mention mention);
/// before, now: as the file has them. unit: of these numbers; empty where they have none.
Diagnostic time_not_increasing(Cell const& cell, double before, double now, std::string const& unit, Mention mention);
Diagnostic unequal_steps(int row, double step, double usual, Mention mention);

}  // namespace sysid::data_errors
