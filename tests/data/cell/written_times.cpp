// Times as programs write them: counts since a date in every notation, patterns in several orders, and what two rows contradict.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/usual_stamps.hpp"
#include "data/table/table.hpp"

using namespace sysid;

namespace {

using Seconds = std::vector<double>;

ReadingRules stamped(std::string stamp, char decimal = '.', char thousands = 0) {
  ReadingRules rules;
  rules.stamp = std::move(stamp);
  rules.decimal = decimal;
  rules.decimal_given = decimal != '.';
  rules.thousands = thousands;
  return rules;
}

std::string rows_of(std::vector<std::string> const& times) {
  std::string text = "t;y\n";
  for (std::string const& time : times) text += time + ";1\n";
  return text;
}

Seconds seconds_in(std::vector<std::string> const& times, ReadingRules const& rules) {
  return Table::parse("run.csv", rows_of(times), std::nullopt, 0, rules).times("t");
}

/// The message about the times, or one without a code.
Diagnostic said_of(std::vector<std::string> const& times, ReadingRules const& rules) {
  try {
    (void)seconds_in(times, rules);
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  return {};
}

bool mentions(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

std::vector<double> steady(double first, double step, int rows) {
  std::vector<double> values;
  for (int i = 0; i < rows; ++i) values.push_back(first + i * step);
  return values;
}

/// As a file has them with this many decimals.
std::vector<double> rounded(std::vector<double> values, int decimals) {
  for (double& value : values) value = std::stod(fmt::format("{:.{}f}", value, decimals));
  return values;
}

std::string counts_of(std::vector<double> const& values, char const* column = "t") {
  SerialTime const* const found = seems_serial(values, column);
  return found == nullptr ? std::string() : std::string(found->word);
}

}  // namespace

TEST_CASE("counts since a date are read in the notation of the file, as other numbers are") {
  CHECK(seconds_in({"45.356", "45.357", "45.358"}, stamped("days", ',', '.')) == Seconds{0, 86400, 172800});
  CHECK(seconds_in({"10.000", "10.250", "1.020.000"}, stamped("milliseconds", ',', '.')) == Seconds{0, 0.25, 1010});
  CHECK(seconds_in({"45356,5", "45357,25"}, stamped("days", ',')) == Seconds{0, 64800});
  CHECK(seconds_in({"45356.5", "45357.25"}, stamped("days")) == Seconds{0, 64800});
  CHECK(seconds_in({"1 714 500 000", "1 714 500 001,5"}, stamped("seconds", ',', ' ')) == Seconds{0, 1.5});
  CHECK(said_of({"45356,5", "45357,25"}, stamped("days")).code == "E4024");
  CHECK(said_of({"45356.5", "45357.25"}, stamped("days", ',')).code == "E4024");
  CHECK(said_of({"10.000", "10.25"}, stamped("milliseconds", ',', '.')).code == "E4024");
}

TEST_CASE("points in counts that may group digits are asked about as in other columns") {
  CHECK(said_of({"998", "999", "1.000", "1.001", "1.002"}, stamped("milliseconds")).code == "E4021");
  CHECK(said_of({"998", "999", "1000", "1001"}, stamped("milliseconds")).code.empty());
}

TEST_CASE("counts with an exponent are read to their last digit") {
  CHECK(seconds_in({"1.714500000000000000e+09", "1.714500060250000000e+09"}, stamped("seconds")) == Seconds{0, 60.25});
  CHECK(seconds_in({"1.7145e+18", "1.714500000000000256e18"}, stamped("nanoseconds")) == Seconds{0, 256e-9});
  CHECK(seconds_in({"1714500000e0", "171450000100E-2", "17145e5"}, stamped("seconds")) == Seconds{0, 1, 0});
  CHECK(seconds_in({"5e-3", "0.015", "25e-3"}, stamped("seconds")) == Seconds{0, 0.01, 0.02});
  // A minute each in doubles printed with 19 digits, of which they have 16: numpy.savetxt.
  CHECK(seconds_in({"4.535650000000000000e+04", "4.535650069444444671e+04", "4.535650138888888614e+04"}, stamped("days")) ==
        Seconds{0, 60, 120});
  for (char const* const none : {"1e", "e5", ".", "1e5x", "1.5.2", "1e99", "--1", ""}) {
    CAPTURE(none);
    CHECK_FALSE(read_serial(none, *find_serial_time("seconds")));
  }
  CHECK(mentions(said_of({"45356", "noon"}, stamped("days")).help, "every cell is a number"));
}

TEST_CASE("counts whose seconds have more than 64 bits are refused, and those of far times are not") {
  CHECK(said_of({"999999999999999000", "999999999999999001"}, stamped("days")).code == "E4024");
  CHECK(seconds_in({"9999999999998", "9999999999999"}, stamped("days")) == Seconds{0, 86400});
  CHECK(seconds_in({"999999999999999998", "999999999999999999"}, stamped("seconds")) == Seconds{0, 1});
  CHECK(seconds_in({"-1.5", "2.25"}, stamped("seconds")) == Seconds{0, 3.75});
  constexpr std::int64_t far = std::int64_t{1} << 62U;
  CHECK(seconds_between({-far - far, 0}, {far, 0}) == 3 * std::ldexp(1, 62));
}

TEST_CASE("equal steps of days are those of the clock, whether or not its times are round") {
  for (double const rate : {128.0, 100.0, 50.0, 60.0, 1.0 / 60}) {
    CAPTURE(rate);
    std::vector<std::string> times;
    for (int i = 0; i < 200; ++i) times.push_back(fmt::format("{:.10f}", 45356.5 + i / rate / 86400));
    Seconds const seconds = seconds_in(times, stamped("days"));
    for (int i = 0; i < 200; ++i) CHECK(std::fabs(seconds[static_cast<std::size_t>(i)] - i / rate) < 2e-5 + 1e-12 * i / rate);
    double longest = 0, shortest = 1e9;
    for (std::size_t i = 1; i < seconds.size(); ++i) {
      longest = std::max(longest, seconds[i] - seconds[i - 1]);
      shortest = std::min(shortest, seconds[i] - seconds[i - 1]);
    }
    CHECK(longest - shortest < 1e-9 * longest);
  }
  // A clock that is off now and then stays so.
  std::vector<std::string> times;
  for (int i = 0; i < 50; ++i) times.push_back(fmt::format("{:.10f}", 45356.5 + (i + (i % 7 == 3 ? 0.2 : 0)) / 128 / 86400));
  Seconds const seconds = seconds_in(times, stamped("days"));
  CHECK(seconds[4] - seconds[3] < 0.9 / 128);
}

TEST_CASE("a year of two digits may stand first or last, and the order without gaps is the first choice") {
  using Patterns = std::vector<std::string>;
  Patterns const halves{"24.05.01 00:00:00", "24.05.01 12:00:00", "24.05.02 00:00:00", "24.05.02 12:00:00"};
  CHECK(patterns_of(halves) == Patterns{"YY.MM.DD hh:mm:ss", "DD.MM.YY hh:mm:ss"});
  CHECK(question_of(patterns_of(halves), halves) == "`24.05.01 00:00:00` may have the day or the year first");
  Patterns const german{"01.05.24 23:00", "02.05.24 00:00", "02.05.24 01:00"};
  CHECK(patterns_of(german) == Patterns{"DD.MM.YY hh:mm", "YY.MM.DD hh:mm"});
  CHECK(patterns_of({"01.05.32 23:00", "02.05.32 00:00"}) == Patterns{"DD.MM.YY hh:mm"});  // no day of a month
  CHECK(patterns_of({"32.05.01 23:00", "32.05.02 00:00"}) == Patterns{"YY.MM.DD hh:mm"});
  Patterns const dashes = patterns_of({"24-05-01 00:00:00", "24-05-01 12:00:00", "24-05-02 00:00:00"});
  CHECK(dashes == Patterns{"YY-MM-DD hh:mm:ss", "DD-MM-YY hh:mm:ss"});
  Patterns const any{"05/04/03 10:00", "05/04/03 10:01", "05/04/03 10:02"};
  CHECK(question_of(patterns_of(any), any) == "`05/04/03 10:00` may have the day, the month or the year first");
  Patterns const four{"03/04/2024 10:00", "03/04/2024 10:01"};
  CHECK(question_of(patterns_of(four), four) == "`03/04/2024 10:00` may have the day or the month first");
}

TEST_CASE("behind a colon stand digits of a fraction, frames or milliseconds, and only the first are proposed") {
  CHECK(patterns_of({"10:00:00:000", "10:00:00:250", "10:00:00:500"}) == std::vector<std::string>{"hh:mm:ss:f"});
  CHECK(patterns_of({"10:00:00:00", "10:00:00:01", "10:00:00:23", "10:00:01:00"}).empty());  // frames
  CHECK(patterns_of({"10:00:00:7", "10:00:00:17", "10:00:00:127"}).empty());                 // milliseconds without zeros
  CHECK(patterns_of({"10:00:00.5", "10:00:00.75"}) == std::vector<std::string>{"hh:mm:ss.f"});
  CHECK(seconds_in({"10:00:00:00", "10:00:00:25"}, stamped("hh:mm:ss:f")) == Seconds{0, 0.25});  // who says so
  CHECK(said_of({"10:00:00:7", "10:00:00:17"}, stamped("hh:mm:ss:f")).code == "E4024");
  CHECK(seconds_in({"10:00:00.5", "10:00:00.75"}, stamped("hh:mm:ss.f")) == Seconds{0, 0.25});
  std::string const help = said_of({"10:00:00:00", "10:00:00:01"}, {}).help;
  CHECK(mentions(help, "give `rate`"));
  CHECK(mentions(help, "`read stamp = \"hh:mm:ss:f\"`"));
}

TEST_CASE("a zone stands in all rows or in none") {
  ReadingRules const iso = stamped("iso");
  Diagnostic const mixed = said_of({"2024-05-01 12:00:00+02:00", "2024-05-01 12:00:01+02:00", "2024-05-01 12:00:02"}, iso);
  CHECK(mixed.code == "E4024");
  CHECK(mentions(mixed.message, "row 3"));
  CHECK(said_of({"2024-05-01 12:00:00", "2024-05-01 12:00:01Z"}, iso).code == "E4024");
  CHECK(seconds_in({"2024-05-01T12:00:00Z", "2024-05-01T14:00:01+02:00"}, iso) == Seconds{0, 1});
  CHECK(seconds_in({"2024-05-01T12:00:00", "2024-05-01T12:00:01"}, iso) == Seconds{0, 1});
}

TEST_CASE("months have English or German names, short or in full, and those of other languages are not taken for them") {
  ReadingRules const named = stamped("DD MMM YYYY");
  for (char const* const name : {"Nov", "November", "NOV", "november"}) {
    CAPTURE(name);
    CHECK(seconds_in({"31 October 2024", fmt::format("1 {} 2024", name)}, named) == Seconds{0, 86400});
  }
  for (char const* const name : {"Mar", "March", "März", "Mrz"}) {
    CAPTURE(name);
    CHECK(seconds_in({"29 Feb 2024", fmt::format("1 {} 2024", name)}, named) == Seconds{0, 86400});
  }
  for (char const* const name : {"marraskuu", "octubr", "maj", "Decemberish"}) {
    CAPTURE(name);
    CHECK(said_of({"29 Feb 2024", fmt::format("1 {} 2024", name)}, named).code == "E4024");
  }
  CHECK(patterns_of({"1 marraskuu 2024 10:00:00", "1 marraskuu 2024 10:01:00"}).empty());
}

TEST_CASE("a narrow or unbreakable blank is a blank in times") {
  for (char const* const blank : {" ", "\u202f", "\u00a0"}) {
    CAPTURE(blank);
    std::vector<std::string> const cells{fmt::format("1/15/2024 11:59:00{}AM", blank),
                                         fmt::format("1/15/2024 12:01:00{}PM", blank)};
    CHECK(is_time_stamp(cells[0]));
    CHECK(patterns_of(cells) == std::vector<std::string>{"MM/DD/YYYY hh:mm:ss AP"});
    CHECK(seconds_in(cells, stamped("MM/DD/YYYY hh:mm:ss AP")) == Seconds{0, 120});
  }
}

TEST_CASE("numbers are days where each step is one of a clock, and seconds of a day are not") {
  // What spreadsheets, MATLAB and pandas write: a double in full, or fewer decimals.
  for (double const step : {1.0, 2.0, 10.0, 60.0, 600.0, 0.1, 0.01}) {
    CAPTURE(step);
    CHECK(counts_of(steady(45356.5, step / 86400, 50)) == "days");
    CHECK(counts_of(steady(739000.5, step / 86400, 50)) == "days");
    if (step >= 1) CHECK(counts_of(rounded(steady(45356.5, step / 86400, 50), 8)) == "days");
  }
  // Seconds since midnight, and of long runs: regular, rounded, and of a clock that is off.
  for (double const step : {1.0, 0.1, 0.01, 1.0 / 128, 1.0 / 1024, 0.25, 60.0, 2.0, 0.0125})
    for (int const decimals : {2, 3, 5, 6, 7, 12}) {
      CAPTURE(step);
      CAPTURE(decimals);
      auto const values = rounded(steady(36000, step, 60), decimals);
      if (values.back() > values[58]) CHECK(counts_of(values) == "");
    }
  CHECK(counts_of({36000.000, 36001.013, 36002.021, 36003.008, 36004.017}) == "");
  CHECK(counts_of({36000.0, 36060.5, 36120.0, 36180.5}) == "");
  CHECK(counts_of({30000.0000, 30002.3333, 30004.6667, 30007.0000}) == "");
  CHECK(counts_of({36000.00000, 36000.01001, 36000.02001, 36000.03003}) == "");
}

TEST_CASE("a column is called after a date where a word of its name says so") {
  std::vector<double> const values{30000.0, 30000.1, 30000.2};
  for (char const* const name : {"Date", "DateTime", "datenum", "start_date", "StartDate", "Datum", "excel time", "serial_date"}) {
    CAPTURE(name);
    CHECK(counts_of(values, name) == "days");
  }
  for (char const* const name : {"update_t", "t", "mandated", "Updated", "time", "candidate"}) {
    CAPTURE(name);
    CHECK(counts_of(values, name) == "");
  }
}

TEST_CASE("`0:05` may be hours and minutes or minutes and seconds, as `00:05` may") {
  using Patterns = std::vector<std::string>;
  CHECK(patterns_of({"0:00", "0:05", "0:10", "1:45"}) == Patterns{"hh:mm", "mm:ss"});
  CHECK(patterns_of({"00:00", "00:05", "00:10"}) == Patterns{"hh:mm", "mm:ss"});
  CHECK(patterns_of({"0:00", "0:05", "26:35"}) == Patterns{"mm:ss.f"});  // no day has so many hours
  CHECK(patterns_of({"8:00:00", "8:00:05"}) == Patterns{"hh:mm:ss"});
  CHECK(seconds_in({"0:05", "1:45"}, stamped("mm:ss")) == Seconds{0, 100});
  CHECK(seconds_in({"9:59.5", "10:00.0"}, stamped("mm:ss.f")) == Seconds{0, 0.5});
  CHECK(said_of({"8:5:00", "8:06:00"}, stamped("hh:mm:ss")).code == "E4024");
}

TEST_CASE("elapsed times go on beyond a day, and a time of day begins again at midnight") {
  CHECK(seconds_in({"23:59:59", "24:00:00", "25:13:02", "125:00:00"}, stamped("hh:mm:ss")) == Seconds{0, 1, 4383, 363601});
  CHECK(seconds_in({"59:59.5", "60:00.0", "125:00.0"}, stamped("mm:ss.f")) == Seconds{0, 0.5, 3900.5});
  CHECK(seconds_in({"23:59:59", "00:00:01"}, stamped("hh:mm:ss")) == Seconds{0, 2});
  // A counter that has passed a day and falls has been set back: no midnight lies between.
  CHECK(seconds_in({"25:00:00", "00:00:01"}, stamped("hh:mm:ss")) == Seconds{0, -89999});
  CHECK(said_of({"2024-01-01 25:00:00"}, stamped("YYYY-MM-DD hh:mm:ss")).code == "E4024");
  CHECK(said_of({"12:00:00", "12:75:00"}, stamped("hh:mm:ss")).code == "E4024");
  CHECK(patterns_of({"23:59:59", "25:13:02"}) == std::vector<std::string>{"hh:mm:ss"});
  CHECK(patterns_of({"00:00", "25:30", "59:59"}) == std::vector<std::string>{"mm:ss.f"});  // no hours, which end at 24:00
}

TEST_CASE("the name of a column says whether two numbers are minutes and seconds or hours and minutes") {
  using Patterns = std::vector<std::string>;
  Patterns const cells{"0:00", "0:10", "1:20"}, minutes{"mm:ss"}, hours{"hh:mm"}, both{"hh:mm", "mm:ss"};
  for (char const* name : {"Zeit (min:sec)", "mm:ss", "t [m:s]", "Time MM:SS"}) {
    CAPTURE(name);
    CHECK(patterns_of(cells, name) == minutes);
  }
  for (char const* name : {"Zeit (hh:mm)", "h:min", "Uhrzeit Std:Min"}) {
    CAPTURE(name);
    CHECK(patterns_of(cells, name) == hours);
  }
  for (char const* name : {"Zeit", "hh:mm:ss", "comm:ssh"}) {
    CAPTURE(name);
    CHECK(patterns_of(cells, name) == both);
  }
}
