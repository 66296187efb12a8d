// Names that end in another unit, and times that were rounded: `check` says so, with lines that work.
#include "experiment/doubtful_columns.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "app/checking.hpp"
#include "app/running.hpp"

using namespace sysid;

namespace {

using Messages = std::vector<std::string>;

// A slow drive and a response at 256 Hz; times in whole milliseconds, or in full.
CheckResult check_of(std::string const& names, std::string const& columns, bool rounded = false) {
  TemporaryFolder folder;
  std::string table = names + "\n";
  for (int i = 0; i < 500; ++i) {
    double const ms = i * 1000 / 256.0;
    table += fmt::format("{},{:.6g},{:.6g}\n", rounded ? std::round(ms) : ms, 20 * std::sin(0.05 * i), 3 * std::cos(0.05 * i));
  }
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid",
                 "model m {\n input u [N]\n state y [m]\n initial y = 0.003\n parameter c [1/s] ~ log_uniform(0.1, 10)\n"
                 " parameter b [m/(N s)] ~ log_uniform(0.01, 10)\n y' = b*u - c*y\n observe z [m] ~ normal(y, sd = 0.001 [m])\n}\n"
                 "data record { file \"record.csv\"; " +
                     columns + " }\nposterior = fit m to record with map, seed = 1\n");
}

Severity severity_of(CheckResult const& result, FindingCode code) {
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == code) return each.severity;
  return Severity::error;
}
std::string help_of(CheckResult const& result, FindingCode code) {
  for (Finding const& each : task(result, "posterior").findings)
    if (each.code == code) return each.help;
  return {};
}

}  // namespace

TEST_CASE("a column that is read in another unit than its name ends in is named, as a note where the data block has it so") {
  std::string const names = "t_ms,Kraft_kN,Weg_mm";
  CheckResult const bare = check_of(names, "time t_ms; input u = Kraft_kN hold linear; measure z = Weg_mm [mm]");
  CHECK(messages(bare, "unit_in_name") == Messages{"column `t_ms` of record is read in s, but its name ends in ms",
                                                   "column `Kraft_kN` of record is read in N, but its name ends in kN"});
  CHECK(severity_of(bare, FindingCode::unit_in_name) == Severity::warning);
  CHECK(help_of(bare, FindingCode::unit_in_name) ==
        "if the name is right, write `t_ms [ms]` in the data block; if not, `t_ms [s]`");
  CheckResult const stated = check_of(names, "time t_ms [ms]; input u = Kraft_kN [N] hold linear; measure z = Weg_mm [mm]");
  CHECK(messages(stated, "unit_in_name") == Messages{"column `Kraft_kN` of record is read in N, but its name ends in kN"});
  CHECK(severity_of(stated, FindingCode::unit_in_name) == Severity::note);
  CHECK(messages(check_of(names, "time t_ms [ms]; input u = Kraft_kN [kN] hold linear; measure z = Weg_mm [mm]"), "unit_in_name")
            .empty());
}

TEST_CASE("names that end like another unit, and in the right one, are left alone") {
  CHECK(
      messages(check_of("t_s,F_N,x_m", "time t_s; input u = F_N [kN] hold linear; measure z = x_m [mm]"), "unit_in_name").empty());
  CHECK(messages(check_of("t,k_1,x_cm", "time t [ms]; input u = k_1 hold linear; measure z = x_cm"), "unit_in_name").empty());
  CHECK(messages(check_of("t,y_kN,x_degC", "time t [ms]; input u = y_kN [kN] hold linear; measure z = x_degC [mm]"), "unit_in_name")
            .empty());
}

TEST_CASE("turns in a minute have one number in rpm and 1/min, and cycles and radians are not converted") {
  auto const of = [](std::string const& name, std::string const& unit, std::string const& written) {
    TemporaryFolder folder;
    std::string table = name + "\n";
    for (int i = 0; i < 50; ++i) table += fmt::format("{:.6g}\n", 3000 + std::sin(1.7 * i));
    write_file(folder.path() / "record.csv", table);
    return checked(folder.path() / "m.sysid", "model m {\n parameter n [" + unit + "] ~ log_uniform(0.1, 1e6)\n observe z [" +
                                                  unit + "] ~ normal(n, sd = 1 [" + unit +
                                                  "])\n}\ndata record { file \"record.csv\"; " + written +
                                                  " }\nposterior = fit m to record with map, seed = 1\n");
  };
  CHECK(messages(of("w_rpm", "1/min", "measure z = w_rpm"), "unit_in_name").empty());
  CHECK(messages(of("N (rpm)", "1/min", "measure z = \"N (rpm)\" [1/min]"), "unit_in_name").empty());
  CheckResult const frequency = of("f_Hz", "rad/s", "measure z = f_Hz");
  CHECK(messages(frequency, "unit_in_name").size() == 1);
  CHECK(help_of(frequency, FindingCode::unit_in_name).find("2*pi") != std::string::npos);
  CHECK(messages(of("f_Hz", "Hz", "measure z = f_Hz"), "unit_in_name").empty());
  // A difference of temperatures, as a name calls it.
  CHECK(messages(of("dT_degC", "delta_degC", "measure z = dT_degC"), "unit_in_name").empty());
  CheckResult const kelvin = of("dT_degC", "K", "measure z = dT_degC");
  CHECK(help_of(kelvin, FindingCode::unit_in_name).find("`dT_degC [delta_degC]` if it is a difference") != std::string::npos);
}

TEST_CASE("rounded times are named with the rate that reads them, which is then no finding") {
  std::string const rest = "; input u = force hold linear; measure z = level [mm]";
  CheckResult const rounded = check_of("t,force,level", "time t [ms]" + rest, true);
  CHECK(messages(rounded, "times_rounded") ==
        Messages{"the time steps of record are 3 or 4 ms: this results if times at equal steps, 256 Hz, are rounded"});
  std::string const help = help_of(rounded, FindingCode::times_rounded);
  std::size_t const from = help.find('`') + 1;
  std::string const cure = help.substr(from, help.find('`', from) - from);
  CHECK(cure == "rate 256 [Hz]");
  CHECK(messages(check_of("t,force,level", cure + rest, true), "times_rounded").empty());
  CHECK(messages(check_of("t,force,level", "time t [ms]" + rest), "times_rounded").empty());
  // In seconds, which the name denies, the rate would be a thousandth of the true one.
  CheckResult const doubtful = check_of("t_ms,force,level", "time t_ms" + rest, true);
  CHECK(messages(doubtful, "times_rounded").empty());
  CHECK(messages(doubtful, "unit_in_name").size() == 1);
  CHECK(messages(check_of("t_ms,force,level", "time t_ms [ms]" + rest, true), "times_rounded").size() == 1);
}

namespace {

/// 256 Hz in milliseconds from 12.345 s on, and a wave; `time`: of the record, as a cell.
CheckResult check_wave(std::string const& model, std::string const& block, std::string (*time)(double)) {
  TemporaryFolder folder;
  std::string table = "time,y\n";
  for (int i = 0; i < 300; ++i) table += fmt::format("{},{:.6g}\n", time(12.345 + i / 256.0), std::cos(0.05 * i));
  write_file(folder.path() / "record.csv", table);
  return checked(folder.path() / "m.sysid", model + "data record { file \"record.csv\"; " + block +
                                                "; measure z = y }\nposterior = fit m to record with map, seed = 1\n");
}

std::string seconds(double time) { return fmt::format("{:.3f}", time); }
std::string date(double time) { return fmt::format("2024-05-01 12:00:{:06.3f}", time); }

std::string driven(std::string const& force) {
  return "model m {\n time t\n state y [1]\n initial y = 1\n parameter c [1/s] ~ log_uniform(0.1, 10)\n y' = " + force +
         " - c*y\n observe z ~ normal(y, sd = 0.1)\n}\n";
}

}  // namespace

TEST_CASE("a rate in place of rounded times says where the time then begins, if the model reads it") {
  std::string const plain = help_of(check_wave(driven("0 [1/s]"), "time time", seconds), FindingCode::times_rounded);
  CHECK(plain.ends_with("bias the estimates (the time then begins at 0)"));
  std::string const reading =
      help_of(check_wave(driven("1 [1/s]*sin(2 [1/s]*t)"), "time time", seconds), FindingCode::times_rounded);
  CHECK(reading.ends_with("the time then begins at 0: add 12.345 [s] to it where the model reads it"));
}

TEST_CASE("rounded dates are named as rounded numbers are, and read by the same rate") {
  std::string const stamps = "read stamp = iso; ";
  CheckResult const rounded = check_wave(driven("0 [1/s]"), stamps + "time time", date);
  CHECK(messages(rounded, "times_rounded").size() == 1);
  CHECK(
      help_of(rounded, FindingCode::times_rounded).starts_with("if the samples were taken at equal steps, write `rate 256 [Hz]`"));
  CHECK(messages(check_wave(driven("0 [1/s]"), stamps + "rate 256 [Hz]", date), "times_rounded").empty());
  auto const in_full = [](double time) { return fmt::format("2024-05-01 12:00:{:012.9f}", time); };
  CHECK(messages(check_wave(driven("0 [1/s]"), stamps + "time time", in_full), "times_rounded").empty());
}

TEST_CASE("a model in discrete time asks for the rate of rounded times") {
  std::string const step =
      "model m {\n time discrete\n parameter a ~ normal(0, sd = 2)\n"
      " observe z ~ normal(a*lag(measured(z), 1), sd = 0.1)\n}\n";
  std::vector<Diagnostic> const refused = check_wave(step, "time time", seconds).diagnostics.all();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].code == "E4203");
  CHECK(refused[0].help ==
        "equal steps give these times when they are rounded: write `rate 256 [Hz]` in place of `time` in `record`");
  CHECK(check_wave(step, "rate 256 [Hz]", seconds).diagnostics.all().empty());
}

TEST_CASE("a time that is called after another unit than it is read in is named, as a warning also where the block states it") {
  std::string const rest = "; input u = force hold linear; measure z = level [mm]";
  auto const named = [&](std::string const& column, std::string const& unit) {
    return check_of(column + ",force,level", "time " + column + unit + rest);
  };
  CheckResult const stated = named("hours", " [day]");
  CHECK(messages(stated, "unit_in_name") == Messages{"column `hours` of record is read in day, but its name is that of a unit, h"});
  CHECK(severity_of(stated, FindingCode::unit_in_name) == Severity::warning);
  CHECK(help_of(stated, FindingCode::unit_in_name) ==
        "if the name is right, write `time hours [h]` in the data block; if not, give the column another name in the file");
  CheckResult const bare = named("Minuten", "");
  CHECK(messages(bare, "unit_in_name") == Messages{"column `Minuten` of record is read in s, but its name is that of a unit, min"});
  CHECK(help_of(bare, FindingCode::unit_in_name) ==
        "if the name is right, write `time Minuten [min]` in the data block; if not, `time Minuten [s]`");
  for (std::string const column : {"minutes", "min", "day", "Stunden", "elapsed_years", "Jahr", "h"}) {
    CAPTURE(column);
    CHECK(messages(named(column, ""), "unit_in_name").size() == 1);
  }
  CHECK(messages(named("minutes", " [min]"), "unit_in_name").empty());
  CHECK(messages(named("years", " [year]"), "unit_in_name").empty());
  for (std::string const column : {"seconds", "Sekunden", "sec", "t", "time", "days_since", "minimum"}) {
    CAPTURE(column);
    CHECK(messages(named(column, ""), "unit_in_name").empty());
  }
  // What is not the time is a minimum, the length of a day, a height.
  CHECK(messages(check_of("t,days,min", "time t [ms]; input u = days hold linear; measure z = min [mm]"), "unit_in_name").empty());
}

TEST_CASE("columns that are exchanged by their names are named with the lines that exchange them again") {
  auto const of = [](std::string const& columns, std::string const& inputs = "load [kN], temp [degC]") {
    TemporaryFolder folder;
    std::string table = "load,temp,gap,t_kN\n";
    for (int i = 0; i < 60; ++i)
      table += fmt::format("{:.6g},{:.6g},{:.6g},{}\n", 5 + std::sin(1.7 * i), 20 + std::cos(0.9 * i), 2 + std::sin(0.3 * i), i);
    write_file(folder.path() / "record.csv", table);
    std::string const first = inputs.substr(0, inputs.find(' ')),
                      second = inputs.find("temp") != std::string::npos ? "temp" : "gap";
    return checked(folder.path() / "m.sysid", "model m {\n input " + inputs + "\n parameter a [mm/kN] ~ normal(0, sd = 2)\n" +
                                                  " parameter b [mm/degC] ~ normal(0, sd = 1)\n observe gap [mm] ~ normal(a*" +
                                                  first + " + b*" + second +
                                                  ", sd = 0.1 [mm])\n}\ndata record { file \"record.csv\"; " + columns +
                                                  " }\nposterior = fit m to record with map, seed = 1\n");
  };
  CheckResult const exchanged = of("input load = temp [kN]; input temp = load [degC]; measure gap = gap [mm]");
  CHECK(messages(exchanged, "column_used_twice") ==
        Messages{"load is read from column `temp` of record, and column `load` is read for temp: the two may be exchanged"});
  std::string const help = help_of(exchanged, FindingCode::column_used_twice);
  CHECK(help == "if so, write `input load = load [kN]` and `input temp = temp [degC]`");
  std::string cure;
  for (std::size_t from = help.find('`'); from != std::string::npos; from = help.find('`', help.find('`', from + 1) + 1))
    cure += help.substr(from + 1, help.find('`', from + 1) - from - 1) + "; ";
  CHECK(messages(of(cure + "measure gap = gap [mm]"), "column_used_twice").empty());
  // One name is that of a column, as `level` and `u`.
  CheckResult const half = of("input load = gap [kN]; input temp = temp [degC]; measure gap = load [mm]");
  CHECK(help_of(half, FindingCode::column_used_twice) == "if so, write `input load = load [kN]` and `measure gap = gap [mm]`");
  CheckResult const own = of("input x = gap [kN]; input temp = temp [degC]; measure gap = load [mm]", "x [kN], temp [degC]");
  CHECK(messages(own, "column_used_twice") ==
        Messages{"gap is read from column `load` of record, and column `gap` is read for x: the two may be exchanged"});
  // No name is that of a column that is read for something else.
  CHECK(messages(of("input load = load [kN]; input temp = temp [degC]; measure gap = gap [mm]"), "column_used_twice").empty());
  CHECK(messages(of("input x = load [kN]; input temp = temp [degC]; measure gap = gap [mm]", "x [kN], temp [degC]"),
                 "column_used_twice")
            .empty());
  CHECK(messages(of("input load = t_kN [kN]; input temp = temp [degC]; measure gap = gap [mm]"), "column_used_twice").empty());
  // `t_kN` without its unit is `t`, one letter, which is exchanged with nothing.
  CHECK(messages(of("input t = load [kN]; input temp = t_kN [degC]; measure gap = gap [mm]", "t [kN], temp [degC]"),
                 "column_used_twice")
            .empty());
}
