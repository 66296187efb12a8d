// Dates and times of day by a pattern, as whole seconds and a fraction, so that differences are exact.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct TimeStamp {
  std::int64_t second = 0;      // since 1970-01-01 00:00, or since midnight where the pattern has no date
  std::int64_t picosecond = 0;  // of the second
  int decimals = 0;             // digits of a fraction that stand there
  bool has_zone = false;        // one stands there
};

/// [s], correctly rounded.
double seconds_between(TimeStamp const& from, TimeStamp const& to);

/// `DD.MM.YYYY hh:mm:ss,f`:
///
///   YYYY YY     year; two digits are 1970 to 2069           hh mm ss    24 hours, or 12 hours where AP stands; 1 or 2 digits
///   MM MMM      month as a number, as a name (Jan, Mai)     f           any number of digits of a fraction, which may be left out
///   DD DDD      day of the month, of the year               AP          AM or PM
///   Without a date, AP and zone the first number before seconds may be larger, up to four digits: elapsed time, `25:13:02`.
///   hhmmss hhmm without signs between: zeros in front may be absent, as of a number; 24:00 is the end of a day
///   zone        Z, +02:00, -0500: taken off                 a blank     any number of blanks; any other sign stands for itself
///
/// `iso`: YYYY-MM-DD, a T or a blank, hh:mm, and, where they stand there, seconds, a fraction and a zone.
class StampPattern {
 public:
  /// Nothing for a text that is no such pattern: without hours or a day, or with something twice.
  static std::optional<StampPattern> parse(std::string_view text);

  /// Nothing for a cell that the pattern does not fit, and for dates and times that do not exist.
  std::optional<TimeStamp> read(std::string_view cell) const;

  bool has_date() const { return has_date_; }
  /// [s] after which a pattern without a date begins again: a day, or an hour where it has no hours.
  std::int64_t turn() const { return has_hours_ ? 86400 : 3600; }
  std::string const& text() const { return text_; }
  /// Whether a colon stands before the fraction, as programs also write frames and whole milliseconds: `10:00:00:7`.
  bool has_counted_fraction() const { return text_.find(":f") != std::string::npos; }

 private:
  enum class Part {
    year,
    short_year,
    month,
    month_name,
    day,
    day_of_year,
    hour,
    minute,
    second,
    fraction,
    half,
    zone,
    blank,
    sign
  };
  struct Token {
    Part part;
    char sign = 0;
    bool exact = false;  // a number follows at once, so all digits must be there
  };
  struct Reader;

  /// Of `hhmmss` or `hhmm` at this token: so many digits, of which a number lacks zeros in front; else 0.
  std::size_t packed_digits(std::size_t token) const;

  std::string text_;
  std::vector<Token> tokens_;
  bool has_date_ = false, has_hours_ = true;
  bool elapsed_ = false;  // the first number may go on beyond a day, or an hour: 25:13:02
};

/// Digits in groups between the signs of dates and times: `2024-05-01 12:00:00.5`, `1.5.2024`, `5/1/24 3:00 PM`, `12:00:01`.
bool is_time_stamp(std::string_view text);

}  // namespace sysid
