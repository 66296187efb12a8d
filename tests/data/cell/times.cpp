// Times that are no plain seconds: times of day in digits, durations, numbers of rows.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "core/text/diagnostic.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_doubt.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/record.hpp"
#include "data/temporary_file.hpp"

using namespace sysid;

namespace {

using Numbers = std::vector<double>;

struct Answer {
  std::optional<Record> record;
  std::string code, message, help;
};
/// With `time` as the time column, in `unit`.
Answer read_with(std::string const& text, ReadingRules const& rules = {}, std::string const& time = "t",
                 char const* unit = nullptr) {
  TemporaryFile const file(text);
  RecordRequest wanted;
  wanted.path = file.path();
  wanted.rules = rules;
  wanted.time = ColumnRequest{time, unit != nullptr ? unit_atom(unit) : std::nullopt, std::nullopt, std::nullopt};
  wanted.measured.push_back(ColumnRequest{"y", std::nullopt, std::nullopt, std::nullopt});
  Diagnostics diagnostics;
  Answer answer{load(wanted, diagnostics), {}, {}, {}};
  if (!diagnostics.all().empty()) {
    Diagnostic const& first = diagnostics.all().front();
    answer.code = first.code, answer.message = first.message, answer.help = first.help;
  }
  return answer;
}
ReadingRules with_stamp(std::string const& stamp) {
  ReadingRules rules;
  rules.stamp = stamp;
  return rules;
}
std::string table(std::vector<std::string> const& times) {
  std::string text = "t,y\n";
  for (std::size_t i = 0; i < times.size(); ++i) text += times[i] + fmt::format(",{}\n", i);
  return text;
}
/// hhmmss of seconds since midnight, as NMEA receivers write them.
std::string digits(int tenths, bool zeros) {
  int const of_day = tenths / 10 % 86400, number = of_day / 3600 * 10000 + of_day / 60 % 60 * 100 + of_day % 60;
  return zeros ? fmt::format("{:06}.{}0", number, tenths % 10) : fmt::format("{}", number);
}
bool has(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("times of day in digits are asked about where they pass a minute, and the line that is given reads them") {
  Answer const asked = read_with(table({"115958.00", "115959.00", "120000.00"}));
  CHECK(asked.code == "E4029");
  CHECK(has(asked.message, "120000 after 115959"));
  CHECK(has(asked.help, "`read stamp = \"hhmmss.f\"`"));
  Answer const read = read_with(table({"115958.00", "115959.00", "120000.00"}), with_stamp("hhmmss.f"));
  REQUIRE(read.record);
  CHECK(read.record->time == Numbers{0, 1, 2});
  // At any rate, from any hour, past midnight, with zeros or without.
  for (int const step : {1, 10, 100, 300, 450, 900, 6000})  // tenths of a second
    for (int const start : {300, 35700, 359700, 863700})
      for (bool const zeros : {true, false}) {
        if (!zeros && step < 10) continue;
        CAPTURE(step);
        CAPTURE(start);
        std::vector<std::string> times;
        for (int i = 0; i < 400; ++i) times.push_back(digits(start + i * step, zeros));
        CHECK(read_with(table(times)).code == "E4029");
        Answer const answer = read_with(table(times), with_stamp("hhmmss.f"));
        REQUIRE_MESSAGE(answer.record, answer.message);
        CHECK(answer.record->time.back() == doctest::Approx(39.9 * step).epsilon(1e-12));
      }
}

TEST_CASE("whole minutes in digits have no jump within the hour and are asked about all the same; seconds are read as seconds") {
  Answer const asked = read_with(table({"110100", "110200", "110300"}));
  CHECK(asked.code == "E4029");
  CHECK(has(asked.help, "`read stamp = seconds`"));
  CHECK(read_with(table({"110100", "110200", "110300"}), with_stamp("hhmmss.f")).record->time == Numbers{0, 60, 120});
  CHECK(read_with(table({"110100", "110200", "110300"}), with_stamp("seconds")).record->time == Numbers{0, 100, 200});
}

TEST_CASE("hours and minutes in four digits are asked about, and what fits both patterns has both lines") {
  Answer const hours = read_with(table({"2358", "2359", "2400", "1", "2"}));
  CHECK(hours.code == "E4029");
  CHECK(has(hours.help, "`read stamp = \"hhmm\"`"));
  CHECK(read_with(table({"2358", "2359", "2400", "1", "2"}), with_stamp("hhmm")).record->time == Numbers{0, 60, 120, 180, 240});
  Answer const either = read_with(table({"58", "59", "100", "101"}));
  CHECK(has(either.help, "hhmmss.f"));
  CHECK(has(either.help, "\"hhmm\""));
}

TEST_CASE("seconds of records are no times of day, at whatever steps") {
  for (double const step : {0.001, 0.01, 0.25, 1.0, 5.0, 10.0, 20.0, 25.0, 30.0, 50.0, 60.0, 99.0, 100.0, 150.0, 1000.0, 3600.0})
    for (double const start : {0.0, 1.0, 17.3, 100.0, 950.0, 9999.0})
      for (int const rows : {3, 7, 60, 1000}) {
        Numbers even, jittery;
        for (int i = 0; i < rows; ++i) {
          even.push_back(start + i * step);
          jittery.push_back(even.back() + 0.2 * step * ((i * 7919) % 13) / 13.0);
        }
        CAPTURE(step);
        CAPTURE(start);
        CAPTURE(rows);
        CHECK(seems_clock(even, true).patterns.empty());
        CHECK(seems_clock(jittery, true).patterns.empty());
      }
  CHECK(seems_clock({0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000}, true).patterns.empty());
  CHECK(seems_clock({0, 0.5, 1, 2, 4, 8, 12, 24, 48, 100}, true).patterns.empty());
  CHECK(seems_clock({115958, 115959}, true).patterns.empty());  // two rows have one step
  CHECK(read_with(table({"0", "1", "2"})).record);
}

TEST_CASE("a column that counts the rows is no time without a unit") {
  std::string const text = "RECORD,y\n7,1\n8,2\n9,3\n";
  Answer const asked = read_with(text, {}, "RECORD");
  CHECK(asked.code == "E4029");
  CHECK(has(asked.help, "write `rate` or `step` in place of `time`"));
  CHECK(has(asked.help, "write `[s]` after the column"));
  CHECK(read_with(text, {}, "RECORD", "s").record->time == Numbers{7, 8, 9});
  CHECK(read_with("RECORD,y\n7,1\n8,2\n10,3\n", {}, "RECORD").record);
  CHECK(read_with("t,y\n7,1\n8,2\n9,3\n").record);
}

TEST_CASE("durations are read exactly, and the message about them has the line that reads them") {
  std::string const text = table({"0 sec", "0.01 sec", "1.5 min", "2 hr", "1 day"});
  Answer const asked = read_with(text);
  CHECK(asked.code == "E4010");
  CHECK(has(asked.help, "`read stamp = duration`"));
  Answer const read = read_with(text, with_stamp("duration"));
  REQUIRE_MESSAGE(read.record, read.message);
  CHECK(read.record->time == Numbers{0, 0.01, 90, 7200, 86400});
  CHECK_FALSE(read_duration("3 V"));
  CHECK_FALSE(read_duration("sec"));
  CHECK_FALSE(read_duration("12"));
  CHECK(read_with(table({"0 V", "1 V", "2 V"})).help.find("duration") == std::string::npos);
}

TEST_CASE("a time of day in digits may lack zeros in front, and 24:00 is the end of a day") {
  auto const seconds = [](char const* pattern, char const* cell) -> std::optional<std::int64_t> {
    auto const stamp = StampPattern::parse(pattern)->read(cell);
    return stamp ? std::optional(stamp->second) : std::nullopt;
  };
  CHECK(seconds("hhmmss", "95958") == 9 * 3600 + 59 * 60 + 58);
  CHECK(seconds("hhmmss.f", "5.25") == 5);
  CHECK(seconds("hhmm", "2400") == 86400);
  CHECK_FALSE(seconds("hhmm", "2401"));
  CHECK_FALSE(seconds("hhmmss", "96058"));
  CHECK_FALSE(seconds("YYYYMMDDhhmmss", "2024050195958"));
  CHECK(seconds("YYYYMMDD hhmmss", "20240501 95958").has_value());
}
