// `sysid data`: what is seen in records, and that the data block which it prints reads them.
#include "data/look/record_look.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/record/record_text.hpp"
#include "core/numeric/elementary.hpp"
#include "core/system/files.hpp"
#include "core/text/source.hpp"
#include "data/record.hpp"
#include "data/temporary_file.hpp"
#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::optional<Record> read_by(std::string const& block, std::string& messages) {
  Diagnostics diagnostics;
  Source source("pasted.sysid", block);
  auto const file = load(source, diagnostics);
  std::optional<Record> record;
  if (file) {
    DataBlock const& data = file->data.at(0);
    RecordRequest request;
    request.path = data.path;
    request.rules = data.rules;
    request.step = data.step;
    if (data.time) request.time = ColumnRequest{data.time->column, data.time->unit, std::nullopt, data.time->span};
    for (DataMeasureUse const& use : data.measured)
      request.measured.push_back(ColumnRequest{use.column, use.unit, std::nullopt, use.span});
    record = sysid::load(request, diagnostics);
  }
  for (Diagnostic const& each : diagnostics.all()) messages += each.code + ": " + each.message + "\n  " + each.help + "\n";
  return record;
}

ColumnLook const& column(RecordLook const& look, std::string const& name) {
  for (ColumnLook const& each : look.columns)
    if (each.name == name) return each;
  FAIL("no column " << name);
  return look.columns.front();
}

}  // namespace

TEST_CASE("the data block of every table of a logger reads it") {
  for (auto const& entry : std::filesystem::directory_iterator(SYSID_SOURCE_DIR "/tests/experiment/loggers")) {
    std::string const path = entry.path().string();
    CAPTURE(path);
    RecordLook const look = look_at_record(path);
    CAPTURE(look.block);
    std::string messages;
    auto const record = read_by(look.block, messages);
    CAPTURE(messages);
    CHECK(record);
    if (!record) continue;
    CHECK(record->rows() >= 3);
    CHECK_FALSE(look.time.column.empty() == (look.block.find("  time ") != std::string::npos));
    CHECK(nlohmann::json::parse(record_json(look))["rows"] == record->rows());
    CHECK(record_text(look).find(look.block) != std::string::npos);
  }
}

TEST_CASE("milli-g of an accelerometer is pasted as such, and a mass is asked about") {
  TemporaryFile const file("t,a_z [mg],dose [mg],F [kN]\n0,1000,1,2\n1,1001,2,3\n2,1002,4,3\n");
  RecordLook const look = look_at_record(file.path());
  CHECK(look.block.find("\"a_z [mg]\" [mg_n]") != std::string::npos);
  CHECK(look.block.find("\"dose [mg]\" [mg]") != std::string::npos);
  std::string const text = record_text(look);
  CHECK(text.find("`dose [mg]` is read as a mass, [mg]; if it is an acceleration, write `[mg_n]`") != std::string::npos);
  CHECK(text.find("`a_z [mg]` is read as a mass") == std::string::npos);
  CHECK(text.find("`F [kN]` is read as a mass") == std::string::npos);
}

TEST_CASE("gaps, dead, clipped and drifting channels, coarse steps and frequencies are seen") {
  std::string text = "t,sine,dead,clipped,drift,coarse\n";
  for (int i = 0; i < 1000; ++i) {
    double const time = 0.01 * i, sine = 3 * elementary::sin(2 * std::numbers::pi * 5 * time);
    text += fmt::format("{:.2f},{:.9g},2,{:.9g},{:.9g},{:.2f}\n", time, sine, std::min(sine, 2.0), 4 * time + 0.01 * sine,
                        std::round(sine / 0.25) * 0.25);
  }
  TemporaryFile const file(text);
  RecordLook const look = look_at_record(file.path());
  CHECK(look.rows == 1000);
  CHECK(look.reading.empty());
  CHECK(look.time.column == "t");
  CHECK(look.time.step == relative(0.01, 1e-12));
  CHECK((look.time.gaps == 0 && look.time.unequal == 0));
  ColumnLook const& sine = column(look, "sine");
  REQUIRE(sine.peaks.size() == 1);
  CHECK(sine.peaks[0].frequency == doctest::Approx(5).epsilon(1e-3));
  CHECK(sine.peaks[0].amplitude == doctest::Approx(3).epsilon(0.02));
  CHECK((sine.at_largest == 0 && sine.at_smallest == 0 && sine.drift == 0));
  CHECK(column(look, "dead").dead);
  CHECK(column(look, "clipped").at_largest > 200);
  CHECK(column(look, "clipped").at_smallest == 0);
  CHECK(column(look, "drift").drift == doctest::Approx(40).epsilon(0.01));
  CHECK(column(look, "coarse").quantum == relative(0.25, 1e-12));
  CHECK(record_figure(look).script.find("plot") != std::string::npos);
}

TEST_CASE("a command that a converter holds for some rows is not clipped for that, one that stays longer at an end is") {
  std::string text = "t,held,clipped,rested\n";
  for (int i = 0; i < 1000; ++i) {
    double const held = std::sin(0.7 * (i / 5)), moving = std::sin(0.05 * i);
    text +=
        fmt::format("{:.2f},{:.9g},{:.9g},{:.9g}\n", 0.01 * i, held, std::min(held, 0.8), i < 600 ? 0.1 : std::min(moving, 0.9));
  }
  TemporaryFile const file(text);
  RecordLook const look = look_at_record(file.path());
  CHECK(column(look, "held").at_largest == 0);
  CHECK(column(look, "held").at_smallest == 0);
  CHECK(column(look, "clipped").at_largest > 100);
  CHECK(column(look, "clipped").at_smallest == 0);
  CHECK(column(look, "rested").at_largest > 40);
}

TEST_CASE("the picture of a record names its columns in full, and one line goes through all of a long one") {
  std::string text = "t,displacement_of_the_second_storey\n", spike = text;
  for (int i = 0; i < 9001; ++i) spike += fmt::format("{},{}\n", 0.01 * i, i == 4321 ? 50.0 : std::sin(0.01 * i));
  for (int i = 0; i < 900; ++i) text += fmt::format("{},{}\n", 0.01 * i, std::sin(0.1 * i));
  TemporaryFile const file(text), longer(spike);
  auto const rows = [](std::string const& script) {
    std::size_t const begin = script.find("<< EOD"), end = script.find("\nEOD", begin);
    return std::count(script.begin() + static_cast<std::ptrdiff_t>(begin), script.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  };
  std::string const script = record_figure(look_at_record(file.path())).script;
  CHECK(script.find("displacement_of_the_second_storey") != std::string::npos);
  CHECK(rows(script) == 900);  // as they are
  std::string const of_long = record_figure(look_at_record(longer.path())).script;
  CHECK((rows(of_long) > 900 && rows(of_long) < 2100));
  CHECK(of_long.find(" 50") != std::string::npos);  // what one row holds is kept
}

TEST_CASE("gaps and unequal steps are counted, with the longest gap's place") {
  TemporaryFile const file("t,y\n0,1\n1,2\n2,3\n3.2,4\n4,5\n9,6\n10,7\n11,8\n");
  TimeLook const time = look_at_record(file.path()).time;
  CHECK(time.gaps == 1);
  CHECK(time.longest_gap == 5);
  CHECK(time.longest_gap_row == 6);
  CHECK(time.unequal == 2);
}

TEST_CASE("lines below the table are counted, and the numbers of a receiver's clock are read as times") {
  std::string text = "utc,y\n";
  for (int i = 0; i < 30; ++i) text += fmt::format("{}.00,{}\n", i < 15 ? 115945 + i : 120000 + i - 15, i % 7 + 0.5);
  TemporaryFile const file(text + "\nend of record\nchecksum 1a2b\n"), plain(text);
  RecordLook const look = look_at_record(file.path());
  CHECK(look.lines_below == 2);
  CHECK(record_text(look).find("2 lines below the table are left out") != std::string::npos);
  CHECK(nlohmann::json::parse(record_json(look))["lines_below"] == 2);
  CHECK(look.time.stamps);
  CHECK((look.time.last == 29 && look.time.gaps == 0 && look.time.unequal == 0));
  std::string messages;
  auto const record = read_by(look.block, messages);
  CAPTURE(messages);
  REQUIRE(record);
  CHECK(record->time.back() == 29);
  RecordLook const without = look_at_record(plain.path());
  CHECK(without.lines_below == 0);
  CHECK(record_text(without).find("left out") == std::string::npos);
}

TEST_CASE("each of several readings that are offered reads the file, with its encoding and its stamps") {
  for (bool const latin : {true, false}) {
    CAPTURE(latin);
    std::string text = latin ? "t;y_\xb5m\n" : "t;y\n";
    for (int i = 0; i < 10; ++i) text += fmt::format("{};1,{}\n", latin ? i : 1714500000 + i, 125 + 37 * i);
    TemporaryFile const file(text);
    RecordLook const look = look_at_record(file.path());
    REQUIRE(look.readings.size() == 2);
    CHECK(look.readings[0] == look.reading);
    std::string const first = look.reading.substr(5);
    REQUIRE(look.block.find(first) != std::string::npos);
    for (std::string const& reading : look.readings) {
      CAPTURE(reading);
      CHECK(reading.find(latin ? "encoding = latin1" : "stamp = seconds") != std::string::npos);
      std::string block = look.block, messages;
      block.replace(block.find(first), first.size(), reading.substr(5));
      auto const record = read_by(block, messages);
      CAPTURE(messages);
      REQUIRE(record);
      CHECK(record->time.back() - record->time.front() == 9);
    }
  }
}

TEST_CASE("durations as MATLAB writes them are the time") {
  TemporaryFile const file("Time,y\n0 sec,1.5\n0.01 sec,2\n0.02 sec,2.5\n0.03 sec,2\n");
  RecordLook const look = look_at_record(file.path());
  CHECK(look.block.find("stamp = duration") != std::string::npos);
  CHECK(look.time.last == 0.03);
}

TEST_CASE("a time is found by its name with a unit behind it, else by its equal steps, and an assumed unit is said to be so") {
  auto const table = [](std::string const& names, auto const& time) {
    std::string text = names + "\n";
    for (int i = 0; i < 300; ++i) text += fmt::format("{},{:.5g}\n", time(i), std::sin(0.3 * i));
    return text;
  };
  auto const whole = [](int i) { return 12500 + 4 * i; };
  TemporaryFile const named(table("t_ms,Kraft_kN", whole)), plain(table("time,y", whole)), none(table("a,y", whole)),
      counted(table("a,y", [](int i) { return i + 1; })), ramp(table("Weg_mm,y", whole));
  RecordLook const look = look_at_record(named.path());
  CHECK(look.time.last == doctest::Approx(13.696));
  CHECK_FALSE(look.time.assumed);
  CHECK(look.block.find("time    t_ms [ms]\n") != std::string::npos);
  CHECK(look.block.find("= Kraft_kN [kN]\n") != std::string::npos);
  RecordLook const assumed = look_at_record(plain.path());
  CHECK(assumed.time.assumed);
  CHECK(record_text(assumed).find("`time`, unit assumed: s: 12500 s to ") != std::string::npos);
  RecordLook const by_steps = look_at_record(none.path());
  CHECK(by_steps.time.column == "a");
  CHECK(record_text(by_steps).find("the only column of equal steps") != std::string::npos);
  CHECK(look_at_record(counted.path()).time.column.empty());
  CHECK(look_at_record(ramp.path()).time.column.empty());
  for (char const* const temperature : {"T", "T (C)", "T_s", "T_min"}) {
    std::string heated = std::string(temperature) + ",zeit\n";
    for (int i = 0; i < 50; ++i) heated += fmt::format("{},{}\n", 20 + 0.1 * i * i, 2 * i);
    CHECK(look_at_record(TemporaryFile(heated).path()).time.column == "zeit");
  }
}

TEST_CASE("rounded times are shown and pasted as the rate that check names") {
  std::string text = "t_ms,y\n";
  for (int i = 0; i < 1000; ++i) text += fmt::format("{},{:.5g}\n", 12500 + std::round(i * 1000 / 256.0), std::sin(0.3 * i));
  TemporaryFile const file(text);
  RecordLook const look = look_at_record(file.path());
  CHECK(record_text(look).find("256 Hz (0.00390625 s), equal steps, rounded to 0.001 s") != std::string::npos);
  CHECK(look.block.find("rate    256 [Hz]  # `t_ms` has these times") != std::string::npos);
  std::string messages;
  auto const record = read_by(look.block, messages);
  CAPTURE(messages);
  REQUIRE(record);
  CHECK(record->time.back() == doctest::Approx(999 / 256.0));
}
