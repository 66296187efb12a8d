// Sensors that froze or were clipped, as `check` tells of them, and what resembles them.
#include "experiment/stuck_sensors.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <regex>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

std::string const stuck_text =
    "model m {\n input u [N]\n state y [m]\n initial y = 0\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
    " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
    "data record { file \"record.csv\"; time t [s]; input u = force [N] hold linear; measure z = level [mm] }\n"
    "posterior = fit m to record with map, seed = 1\n";

// level(row, noise) from row 0, noise of sd 1.
CheckResult check_level(std::function<double(int, double)> const& level, std::string const& text = stuck_text) {
  Stream stream({7, Purpose::test, 0, 0});
  std::string table = "t,force,level\n";
  for (int row = 0; row < 300; ++row)
    table += fmt::format("{:.6g},{:.6g},{:.8g}\n", 0.1 * row, elementary::sin(0.05 * row), level(row, stream.normal()));
  TemporaryFolder folder;
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid", text);
}

double wave(int row) { return 3 * elementary::sin(0.05 * row - 0.4); }
double noisy(int row, double noise) { return wave(row) + 0.05 * noise; }

std::string stuck_help(CheckResult const& result) {
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == FindingCode::sensor_stuck) return each.help;
  return {};
}

std::vector<std::string> stuck(std::function<double(int, double)> const& level) {
  return messages(check_level(level), "sensor_stuck");
}

}  // namespace

TEST_CASE("a sensor that froze for half of the record is named by its rows, and the ranges of the help leave them out") {
  auto const frozen = [](int row, double noise) { return row < 150 ? noisy(row, noise) : 1.25; };
  CheckResult const result = check_level(frozen);
  CHECK(messages(result, "sensor_stuck") ==
        std::vector<std::string>{
            "z, column `level` of record, is 1.25 mm in all 150 samples of rows 151 to 300, but changes from sample "
            "to sample elsewhere: the sensor may have been stuck"});
  std::smatch lines;
  std::string const help = stuck_help(result);
  REQUIRE(std::regex_search(help, lines, std::regex("`(split [^`]*)` in `record`, and fit to `([^`]*)`")));
  std::string text = with(stuck_text, "[mm] }", "[mm]; " + lines[1].str() + " }");
  CHECK(messages(check_level(frozen, with(text, "to record", "to " + lines[2].str())), "sensor_stuck").empty());
}

TEST_CASE("a short part that chance cannot repeat is named by the cells to be emptied") {
  auto const frozen = [](int row, double noise) { return row < 200 || row >= 215 ? noisy(row, noise) : 0.7351; };
  CheckResult const result = check_level(frozen);
  CHECK(messages(result, "sensor_stuck").size() == 1);
  CHECK(stuck_help(result) ==
        "if so, empty the cells of column `level` in rows 202 to 215 in the file: these samples are then not scored");
  // As the help says.
  auto const emptied = [&](int row, double noise) { return row > 200 && row < 215 ? std::nan("") : frozen(row, noise); };
  CHECK(messages(check_level(emptied, with(stuck_text, "time t", "read missing = \"nan\"; time t")), "sensor_stuck").empty());
}

TEST_CASE("short runs that a converter, a pause or an end of the range explains are left alone") {
  auto const held = [](int from, double step, double value) {
    return
        [=](int row, double noise) { return row < from || row >= from + 15 ? step * std::round(noisy(row, noise) / step) : value; };
  };
  CHECK(stuck(held(200, 1e-4, 0.7351)).size() == 1);
  CHECK(stuck(held(200, 0.02, 0.74)).empty());  // in steps of nearly the size of the noise: samples repeat elsewhere
  CHECK(stuck(held(0, 1e-4, 0.7351)).empty());  // begins the record
  CHECK(stuck([&](int row, double noise) {      // rests again and again
          return row % 100 >= 85 ? 0.7351 : noisy(row, noise);
        })
            .empty());
}

TEST_CASE("a few samples at an end of the range are clipped where no other sample repeats itself") {
  auto const clipped = [](int row, double noise) {
    double const level = noisy(row, noise);
    return row >= 30 && row < 36 ? 3.4 : level;
  };
  auto const found = stuck(clipped);
  REQUIRE(found.size() == 1);
  CHECK(found[0].find("at its largest value, 3.4 mm, in 6 samples") != std::string::npos);
  // Where a converter makes samples repeat, six equal ones at an end may be a peak.
  CHECK(stuck([&](int row, double noise) { return 0.05 * std::round(clipped(row, noise) / 0.05); }).empty());
}

TEST_CASE("a part in the middle leaves a range on both sides") {
  auto const frozen = [](int row, double noise) { return row < 100 || row >= 160 ? noisy(row, noise) : 1.25; };
  std::string const help = stuck_help(check_level(frozen));
  std::smatch lines;
  REQUIRE(std::regex_search(help, lines, std::regex("`(split [^`]*)` in `record`, and fit to `([^`]*)`")));
  CHECK(lines[1] == "split part_1 = rows 1..101, part_2 = rows 161..300");
  std::string text = with(stuck_text, "[mm] }", "[mm]; " + lines[1].str() + " }");
  CHECK(messages(check_level(frozen, with(text, "to record", "to " + lines[2].str())), "sensor_stuck").empty());
}

TEST_CASE("a sensor whose range ends below the signal is named, and its marks are read as missing") {
  for (double const sign : {1.0, -1.0}) {
    auto const clipped = [sign](int row, double noise) { return sign * std::min(noisy(row, noise), 2.15); };
    CheckResult const result = check_level(clipped);
    auto const found = messages(result, "sensor_stuck");
    REQUIRE(found.size() == 1);
    CHECK(found[0].find(sign > 0 ? "largest value, 2.15 mm" : "smallest value, -2.15 mm") != std::string::npos);
    std::smatch line;
    std::string const help = stuck_help(result);
    REQUIRE(std::regex_search(help, line, std::regex("`(read missing = [^`]*)`")));
    CHECK(messages(check_level(clipped, with(stuck_text, "time t [s]", line[1].str() + "; time t [s]")), "sensor_stuck").empty());
  }
}

TEST_CASE("a sensor that is clipped at both ends is named with both, rough or smooth, and so are the marks of the help") {
  auto const rough = [](int row, double noise) { return std::clamp(noisy(row, noise), -2.15, 2.35); };
  // 19 samples a period, printed with eight digits: no noise to speak of.
  auto const smooth = [](int row, double noise) {
    return std::clamp(3 * elementary::sin(0.33 * row - 0.4) + 0.002 * noise, -2.15, 2.35);
  };
  for (auto const& clipped : {std::function<double(int, double)>(rough), std::function<double(int, double)>(smooth)}) {
    CheckResult const result = check_level(clipped);
    auto const found = messages(result, "sensor_stuck");
    REQUIRE(found.size() == 1);
    CHECK(found[0].find("at its largest value, 2.35 mm, in ") != std::string::npos);
    CHECK(found[0].find(" and at its smallest value, -2.15 mm, in ") != std::string::npos);
    std::smatch line;
    std::string const help = stuck_help(result);
    REQUIRE(std::regex_search(help, line, std::regex("`(read missing = [^`]*)`")));
    CHECK(line[1] == "read missing = (\"2.35\", \"-2.15\")");
    CHECK(messages(check_level(clipped, with(stuck_text, "time t [s]", line[1].str() + "; time t [s]")), "sensor_stuck").empty());
  }
}

TEST_CASE("marks of the help join those that the data block has, and `none`") {
  auto const clipped = [](int row, double noise) { return std::min(noisy(row, noise), 2.15); };
  for (std::string const stated : {"missing = none", "missing = (\"-999\", none)", "missing = \"-999\""}) {
    CAPTURE(stated);
    auto const reading = [&](std::string const& setting) {
      return with(stuck_text, "time t [s]", "read " + setting + "; time t [s]");
    };
    std::smatch line;
    std::string const help = stuck_help(check_level(clipped, reading(stated)));
    REQUIRE_MESSAGE(std::regex_search(help, line, std::regex("write `(missing = [^`]*)` after `read`")), help);
    CHECK((line[1].str().find("none") != std::string::npos) == (stated.find("none") != std::string::npos));
    CHECK((line[1].str().find("-999") != std::string::npos) == (stated.find("-999") != std::string::npos));
    CHECK(messages(check_level(clipped, reading(line[1].str())), "sensor_stuck").empty());
  }
}

TEST_CASE("a smooth record that is clipped at one end is named") {
  auto const found = stuck([](int row, double) { return std::min(3 * elementary::sin(0.33 * row), 2.15); });
  REQUIRE(found.size() == 1);
  CHECK(found[0].find("at its largest value, 2.15 mm, in ") != std::string::npos);
}

TEST_CASE("a number at the end of the range that another column has, too, is taken from its own column alone") {
  auto const clipped = [](int row, double noise) { return std::min(noisy(row, noise), 2.1); };
  std::string const cells =
      "if the range of the sensor ended there, empty these cells of column `level` in the file (`missing` would remove "
      "such numbers from column `{}`, too): these samples are then not scored";
  CHECK(stuck_help(check_level(clipped)) == fmt::format(fmt::runtime(cells), "t"));  // 2.1 s
  auto const emptied = [&](int row, double noise) { return clipped(row, noise) == 2.1 ? std::nan("") : clipped(row, noise); };
  CHECK(messages(check_level(emptied, with(stuck_text, "time t", "read missing = \"nan\"; time t")), "sensor_stuck").empty());
  auto const at_force = [](int row, double noise) { return std::min(noisy(row, noise), 0.997495); };  // sin(1.5)
  CHECK(stuck_help(check_level(at_force)) == fmt::format(fmt::runtime(cells), "force"));
  // Without a column of the time there is none that has it.
  CHECK(stuck_help(check_level(clipped, with(stuck_text, "time t [s]", "rate 10 [Hz]"))).find("`read missing = \"2.1\"`") !=
        std::string::npos);
}

TEST_CASE("smooth records that come to an end of their range by themselves are not clipped") {
  auto const slow = [](int row, double) { return 3 * elementary::sin(0.3317 * row); };
  CHECK(stuck(slow).empty());
  for (double const step : {0.5, 0.25, 0.1, 0.02})  // rounded peaks: of a converter, coarse and fine
    CHECK(stuck([&](int row, double noise) { return step * std::round(slow(row, noise) / step); }).empty());
  for (double const step : {0.05, 0.01})  // with longer periods the peaks are flat for several samples
    CHECK(stuck([&](int row, double) { return step * std::round(3 * elementary::sin(0.1317 * row) / step); }).empty());
  // Saturates smoothly; a ramp between stops; stops that are touched in single samples.
  CHECK(stuck([&](int row, double noise) { return std::round(1e4 * std::tanh(slow(row, noise))) / 1e4; }).empty());
  CHECK(stuck([](int row, double) { return std::clamp(0.1 * std::abs(row % 60 - 30) - 0.5, 0.5, 1.5); }).empty());
  CHECK(stuck([&](int row, double noise) { return std::min(slow(row, noise), 2.95); }).empty());
  // Held for three rows each, as a slow sensor in a fast recorder.
  CHECK(stuck([&](int row, double noise) { return std::clamp(slow(row / 3 * 3, noise), -2.0, 2.0); }).empty());
  // Rests at its end for most of the time, as a valve that closes now and then.
  CHECK(stuck([](int row, double) { return row % 100 < 80 ? 1.0 : 0.5; }).empty());
}

TEST_CASE("what repeats its samples for a reason is no stuck sensor") {
  CHECK(stuck(noisy).empty());
  // In coarse steps: slow, rough, and both while it rests.
  CHECK(stuck([](int row, double) { return std::round(4 * wave(row)) / 4; }).empty());
  CHECK(stuck([](int row, double noise) { return std::round(5 * noisy(row, noise)) / 5; }).empty());
  CHECK(stuck([](int row, double) { return row % 100 < 50 ? 0.0 : 1.0; }).empty());                     // a switch
  CHECK(stuck([](int row, double) { return row < 150 ? 0.0 : 2.0; }).empty());                          // a step
  CHECK(stuck([](int row, double noise) { return row < 120 ? 1.0 : 1 + noisy(row, noise); }).empty());  // at rest, then moved
  CHECK(stuck([](int row, double noise) { return std::max(0.0, noisy(row, noise)); }).empty());         // never below 0
  // A decay that ends below the last digit.
  CHECK(stuck([](int row, double noise) {
          return std::round(1000 * elementary::exp(-0.08 * row) * (elementary::cos(2.1 * row) + 0.1 * noise)) / 1000;
        }).empty());
  // Without noise, at the end of its way.
  CHECK(stuck([](int row, double) { return std::min(0.01 * row, 1.5); }).empty());
}

TEST_CASE("a model that says where its channel ends is not asked about it") {
  auto const clipped = [](int row, double noise) { return std::min(noisy(row, noise), 2.1); };
  CHECK(messages(check_level(clipped), "sensor_stuck").size() == 1);
  CHECK(messages(check_level(clipped, with(stuck_text, "normal(y,", "normal(min(y, 2.1 [mm]),")), "sensor_stuck").empty());
}

TEST_CASE("a frozen part of counts is left alone") {
  std::string const counts = with(
      with(stuck_text, "observe z [m] ~ normal(y, sd = 0.001 [m])", "observe z ~ poisson(exp(y*1 [1/m]))"), "level [mm]", "level");
  CHECK(messages(check_level([](int row, double noise) { return row < 150 ? std::floor(20 + 3 * std::fabs(noise) + row % 9) : 4; },
                             counts),
                 "sensor_stuck")
            .empty());
}
