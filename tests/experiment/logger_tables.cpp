// Tables as loggers and programs write them: each is read as it stands, or refused with a line to add, which then works. The line
// is taken from the message as it is.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "data/record.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

constexpr double none = -1e300;  // in place of a missing sample

struct WantedColumn {
  char const* name;
  std::vector<double> values;
};
struct LoggedTable {
  char const* file;
  char const* time;  // as in the data block; empty: rate
  std::vector<double> seconds;
  std::vector<WantedColumn> columns;
  char const* advice = "";  // the line that the message proposes; empty: read as it stands
  int choice = 0;           // where two are proposed
};

std::vector<LoggedTable> const tables = {
    {"excel_german.csv",
     "Zeit",
     {0, 0.5, 1},
     {{"Kraft (N)", {1234.5, 999.25, 12.5}}, {"Weg [µm]", {0.25, -0.5, 1}}},
     "read names = 2, encoding = latin1, decimal = \",\", thousands = \".\", stamp = \"DD.MM.YYYY hh:mm:ss,f\""},
    {"excel_us.csv",
     "Date",
     {0, 1, 2},
     {{"Load", {1234.5, 2000, 12.25}}, {"Deflection", {0.1, 0.2, 0.3}}},
     "read thousands = \",\", stamp = \"MM/DD/YYYY hh:mm:ss AP\""},
    {"excel_unicode.txt", "Time", {0, 60, 120}, {{"Temp °C", {20.5, 21.25, 22}}}},
    {"excel_swiss.csv", "t", {0, 1, 2}, {{"Kosten", {1234.5, 12000, 7}}}, "read thousands = \"'\""},
    {"labview.lvm",
     "X_Value",
     {0, 0.001, 0.002},
     {{"Force", {1.5, 1.75, 2}}, {"Stroke", {-0.25, -0.5, -0.75}}},
     "read names = 23, decimal = \",\", ragged = yes"},
    {"campbell_toa5.dat",
     "TIMESTAMP",
     {0, 0.5, 1},
     {{"AirTemp_Avg", {20.5, none, 21.5}}, {"WindSpeed", {1.25, 1.5, 1.75}}},
     "read names = 2, units = 3, values = 5, missing = \"NAN\", stamp = iso"},
    {"national_instruments.csv",
     "\"Time (s)\"",
     {0, 0.001, 0.002},
     {{"Voltage_0 (V)", {0.125, 0.25, 0.375}}, {"Acceleration_1 (g)", {-1.5, -1.25, -1}}},
     "read names = 6"},
    {"catman.asc",
     "Zeit",
     {0, 0.01, 0.02},
     {{"Kraft", {1.5, 2.5, 3.5}}, {"Weg", {1e-4, 2e-4, 3e-4}}},
     "read names = 3, units = 4, decimal = \",\""},
    {"dewesoft.csv",
     "\"Time (s)\"",
     {0, 0.001, 0.002},
     {{"Force (kN)", {1.5, 1.6, 1.7}}, {"Disp (mm)", {0.01, 0.02, 0.03}}},
     "read names = 9, values = 10..12, decimal = \",\""},
    {"picoscope.csv",
     "Time [ms]",
     {-1e-3, -0.5e-3, 0},
     {{"Channel A", {0.5, 0.75, 1}}},
     "read units = 2, values = 4, missing = \"-∞\""},
    {"keysight.csv", "\"x-axis\"", {-1e-3, -5e-4, 0}, {{"1", {2.1, 2.2, 2.3}}, {"2", {-0.1, -0.2, -0.3}}}, "read units = 2"},
    {"tektronix.csv",
     "TIME",
     {-2e-9, -1.6e-9, -1.2e-9},
     {{"CH1", {0.0125, 0.025, 0.0375}}, {"CH2", {1.5, 1.25, 1}}},
     "read names = 12"},
    {"origin.txt",
     "Time",
     {0, 0.5, 1},
     {{"Stress", {1.5e6, 2.5e6, 3.5e6}}, {"Strain", {0.001, 0.002, 0.003}}},
     "read units = 2, values = 4"},
    {"pandas.csv", "time", {0, 0.25, 0.5}, {{"force", {1.5, 2.5, 3.5}}, {"flow", {none, 0.5, 0.75}}}, "read stamp = iso"},
    {"r_write_csv.csv", "t", {0, 0.5, 1}, {{"y", {1.5, none, 3.5}}}, "read columns = (\"column_1\", \"t\", \"y\", \"y_2\")"},
    {"r_write_table.txt",
     "column_2",
     {0, 0.5, 1},
     {{"column_3", {1.5, 2.5, 3.5}}},
     "read values = 2, columns = (\"column_1\", \"column_2\", \"column_3\"), separator = blank"},
    {"influx.csv", "_time", {0, 10, 20.5}, {{"_value", {20.5, 21.5, 22.5}}}, "read stamp = iso"},
    {"arduino.log",
     "",
     {0, 1, 2},
     {{"column_2", {512, 513, 511}}, {"column_3", {23.4, 23.5, 23.6}}},
     "read columns = (\"column_1\", \"column_2\", \"column_3\"), separator = blank"},
    {"seismic.txt",
     "column_1",
     {0, 0.05, 0.1},
     {{"column_2", {-120, 15, 131}}},
     "read values = 2, columns = (\"column_1\", \"column_2\"), separator = blank, stamp = iso"},
    {"matlab_writetable.csv",
     "Time",
     {0, 1, 2},
     {{"Force", {1.5, 2.5, 3.5}}, {"Flow", {none, 0.5, 0.75}}},
     "read missing = \"NaN\", stamp = \"DD-MMM-YYYY hh:mm:ss\""},
    {"numpy_savetxt.txt",
     "t",
     {0, 0.01, 0.02},
     {{"force", {1.5, 2.5, 3.5}}, {"y", {-0.1, -0.2, -0.3}}},
     "read names = 1, separator = blank"},
    {"weather_station.csv",
     "Time",
     {0, 600, 1200},
     {{"Temp", {12.5, none, 11.5}}, {"Rain", {0.2, 0.4, 0.6}}},
     "read missing = \"-9999\", stamp = \"DD/MM/YYYY hh:mm:ss\", date = \"Date\""},
    {"night_shift.csv",
     "Uhrzeit",
     {0, 0.5, 1},
     {{"Druck", {1013.25, 1013.5, 1013.75}}},
     "read decimal = \",\", stamp = \"hh:mm:ss,f\""},
    {"comsol.txt",
     "column_1",
     {0, 0.1, 0.2},
     {{"column_2", {0, 0.25, 0.5}}},
     "read values = 4, columns = (\"column_1\", \"column_2\"), separator = blank"},
    {"ambiguous_dates.csv", "when", {0, 60, 120}, {{"y", {1, 2, 3}}}, "read stamp = \"DD/MM/YYYY hh:mm\""},
    {"ambiguous_dates.csv", "when", {0, 60, 120}, {{"y", {1, 2, 3}}}, "read stamp = \"MM/DD/YYYY hh:mm\"", 1},
    {"ambiguous_numbers.csv", "t", {0, 1, 2}, {{"y", {1.25, 2.5, 3.75}}}, "read decimal = \",\""},
    {"ambiguous_numbers.csv", "t", {0, 1, 2}, {{"y", {1250, 2500, 3750}}}, "read thousands = \",\"", 1},
    {"duplicate_names.csv.gz", "t", {0, 0.1, 0.2}, {{"ch", {1, 2, 3}}}, "read columns = (\"t\", \"ch\", \"ch_2\"), ragged = yes"},
    {"rigol.csv",
     "",
     {0, 1, 2},
     {{"column_2", {0.12, 0.16, 0.2}}, {"column_3", {-0.04, -0.08, -0.12}}},
     "read values = 3, columns = (\"column_1\", \"column_2\", \"column_3\", \"column_4\", \"column_5\")"},
    {"tektronix_side.csv",
     "column_4",
     {-0.0005, -0.0004996, -0.0004992, -0.0004988, -0.0004984},
     {{"column_5", {0.004, 0.008, 0.012, 0.016, 0.02}}},
     "read values = 1, columns = (\"column_1\", \"column_2\", \"column_3\", \"column_4\", \"column_5\")"},
    {"siglent.csv",
     "Source",
     {-0.00002, 0, 0.00002},
     {{"CH1", {0.12, 0.13, 0.14}}, {"CH2", {1.5, 1.25, 1}}},
     "read names = 5, units = 6, ragged = yes"},
    {"vaisala.txt",
     "Time",
     {0, 10, 20, 30},
     {{"Humidity [%RH]", {45.25, none, 46.5, 46.75}}},
     "read missing = \"***\", stamp = iso, date = \"Date\""},
    {"siemens_plc.csv",
     "TimeString",
     {0, 1, 2, 3},
     {{"VarValue", {1.5, 1.75, 2, 0}}},
     "read decimal = \",\", stamp = \"DD.MM.YYYY hh:mm:ss\""},
    {"catman_blanks.asc",
     "\"Zeit  1 - Standardmessrate [s]\"",
     {0, 0.02, 0.04},
     {{"Kraft_1 [kN]", {1.5e-3, 2.5e-3, 3.5e-3}}, {"Weg_2 [mm]", {-0.9375, -0.95, -0.975}}},
     "read names = 3, values = 5, encoding = latin1, decimal = \",\""},
    {"excel_francais.csv",
     "\"Temps (s)\"",
     {0, 0.5, 1},
     {{"Débit (l/min)", {1234.5, 1240.25, 999}}, {"Pression (bar)", {2.5, 2.75, 3}}},
     "read encoding = latin1, decimal = \",\", thousands = blank"},
    {"milliseconds_behind_colon.log",
     "Time",
     {0, 0.25, 0.5, 0.75},
     {{"Load", {1.5, 2.5, 3.5, 4.5}}},
     "read stamp = \"hh:mm:ss:f\""},
    {"twelve_hours.csv",
     "Time",
     {0, 0.5, 1, 820801.5},
     {{"Level", {1.5, 2.5, 3.5, 4.5}}},
     "read stamp = \"MM/DD/YYYY hh:mm:ss.f AP\", date = \"Date\""},
    {"old_mac.csv", "t", {0, 0.25, 0.5}, {{"force", {1.5, 2.5, 3.5}}}},
    {"epoch.csv", "timestamp", {0, 0.25, 0.5}, {{"temp", {20.5, 20.75, 21}}}, "read stamp = seconds"},
    {"epoch_milliseconds.csv", "ts", {0, 0.25, 0.5}, {{"value", {20.5, 20.75, 21}}}, "read stamp = milliseconds"},
    {"excel_serial.csv", "Date", {0, 60, 120, 180}, {{"Level", {1.5, 2.5, 3.5, 4.5}}}, "read stamp = days"},
    {"minutes_seconds.csv", "Time", {0, 60, 120}, {{"T", {20.5, 20.75, 21}}}, "read stamp = \"hh:mm\""},
    {"minutes_seconds.csv", "Time", {0, 1, 2}, {{"T", {20.5, 20.75, 21}}}, "read stamp = \"mm:ss\"", 1},
    {"dewetron.txt", "Time", {0, 0.001, 0.002}, {{"Force", {1.5, 2.5, 3.5}}}, "read units = 5"},
    {"over_and_dashes.csv",
     "t",
     {0, 1, 2, 3, 4, 5, 6, 7},
     {{"pressure", {1.5, none, none, 2.5, 3.5, 4.5, 5.5, 6.5}}, {"flow", {0.1, 0.2, none, 0.4, 0.5, 0.6, 0.7, 0.8}}},
     "read missing = (\"OVER\", \"--\", \"n/a\")"},
    {"comments_and_footer.dat",
     "time",
     {0, 0.1, 0.2, 0.3},
     {{"force", {1.5, 2.5, 3.5, 4.5}}, {"stroke", {10, 20, 30, 40}}},
     "read names = 3, values = 4..8, separator = blank, comments = \"!\""},
    {"german_thousands.csv",
     "\"Zeit [s]\"",
     {0, 0.1, 0.2},
     {{"Last [N]", {1234.5, 12345.75, -1000}}, {"Weg [mm]", {0.25, 0.5, 0.75}}},
     "read decimal = \",\", thousands = \".\""},
    {"duplicate_and_units.txt",
     "Time",
     {0, 0.1, 0.2},
     {{"Ch 1", {1.5, 2.5, 3.5}}},
     "read units = 2, columns = (\"Time\", \"Ch 1\", \"Ch 1_2\", \"Remark\")",
     1},
    {"csi.csv", "", {0, 1, 2}, {{"U1", {0.25e-3, 0.5e-3, 0.75e-3}}}, "read names = 3, units = 4"},
    {"gps.nmea",
     "",
     {0, 1, 2},
     {{"column_3", {4807.038, 4807.039, 4807.04}}, {"column_10", {545.4, 545.6, 545.9}}},
     "read values = 1, columns = (\"column_1\", \"column_2\", \"column_3\", \"column_4\", \"column_5\", \"column_6\", "
     "\"column_7\", "
     "\"column_8\", \"column_9\", \"column_10\", \"column_11\")"},
    {"remarks_between.csv", "t", {0, 1, 2}, {{"y", {1, 2, 3}}}, "read values = 2..5, comments = \"#\""},
    {"motec_i2.csv",
     "Time",
     {0, 0.01, 0.02, 0.03},
     {{"Damper Pos FL", {0.03025, 0.0305, 0.03075, 0.031}}},
     "read names = 7, units = 8, values = 10"},
    {"diadem.asc",
     "Zeit",
     {0, 0.002, 0.004},
     {{"Kraft", {1500, 1750, 2000}}, {"Weg", {0.25e-3, 0.5e-3, 0.75e-3}}},
     "read names = 6, units = 7, decimal = \",\", ragged = yes"},
    {"gantner.csv",
     "Timestamp",
     {0, 0.25, 0.5},
     {{"Strain 1", {100.5e-6, 101.25e-6, 99e-6}}, {"Temp Ö", {21.5, 21.75, 22}}},
     "read names = 4, units = 5, stamp = iso"},
    {"stopwatch.csv",
     "\"Zeit (min:sec)\"",
     {0, 10, 80},
     {{"Druck (bar)", {3.25, 3.5, 3.75}}},
     "read decimal = \",\", stamp = \"mm:ss\", ragged = yes"},
    {"elapsed_hours.csv", "Elapsed Time", {0, 900, 5282}, {{"Load [kN]", {10.5, 10.75, 11}}}, "read stamp = \"hh:mm:ss\""},
    {"accelerometer.csv", "\"Time [ms]\" [ms]", {0, 0.005, 0.01}, {{"a_x [mg]", {12.5, -3.25, 4}}}},
    {"arduino_millis.log",
     "millis [ms]",
     {1.003, 1.023, 1.043, 1.063},
     {{"force_N", {2, 1.25, -0.5, -1.75}}},
     "read names = 3, values = 4..7"},
    {"toa5_quoted.dat",
     "TIMESTAMP",
     {0, 0.05, 0.1},
     {{"Acc_Avg(1)", {0.5, 0.25, none}}, {"Acc_Avg(2)", {none, 1.5, 1.75}}},
     "read names = 2, units = 3, values = 5, missing = \"NAN\", stamp = iso"},
    {"catman_utf16.asc",
     "Zeit 1 - Standardmessrate",
     {0, 0.02, 0.04},
     {{"MX840B CH 1", {100.5e-6, -12.25e-6, 7.75e-6}}, {"MX840B CH 2", {5, 4.5, 4}}},
     "read names = 4, units = 5, values = 7, decimal = \",\""},
    {"excel_german_units.csv",
     "Uhrzeit",
     {0, 1, 2},
     {{"Kraft", {1000.5, 998.25, -3.5}}, {"Weg", {2.25e-3, 1.5e-3, 0.75e-3}}},
     "read names = 4, units = 5, encoding = latin1, decimal = \",\", stamp = \"DD.MM.YYYY hh:mm:ss\", date = \"Datum\""},
};

std::string block_of(LoggedTable const& table, std::string const& line) {
  std::string text = fmt::format("data d {{\n  file \"{}\"\n  {}\n", table.file, line);
  std::string const time = table.time;
  bool const quotes = time.find_first_of("\"[") == std::string::npos;
  if (time.empty())
    text += "  rate 1 [Hz]\n";
  else
    text += quotes ? fmt::format("  time \"{}\"\n", time) : fmt::format("  time {}\n", time);
  for (std::size_t i = 0; i < table.columns.size(); ++i) text += fmt::format("  measure m{} = \"{}\"\n", i, table.columns[i].name);
  return text + "}\n";
}

struct Answer {
  std::optional<Record> record;
  std::string messages;
  std::string help;  // of the first message
};

Answer read(std::string const& text) {
  Answer answer;
  Diagnostics diagnostics;
  Source source("loggers.sysid", text);
  auto const file = load(source, diagnostics);
  if (file) {
    DataBlock const& block = file->data.at(0);
    RecordRequest request;
    request.path = std::string(SYSID_SOURCE_DIR "/tests/experiment/loggers/") + block.path;
    request.rules = block.rules;
    request.step = block.step;
    if (block.time) request.time = ColumnRequest{block.time->column, block.time->unit, std::nullopt, block.time->span};
    for (DataMeasureUse const& use : block.measured)
      request.measured.push_back(ColumnRequest{use.column, use.unit, std::nullopt, use.span});
    answer.record = sysid::load(request, diagnostics);
  }
  for (Diagnostic const& each : diagnostics.all()) {
    answer.messages += each.code + ": " + each.message + "\n  help: " + each.help + "\n";
    if (answer.help.empty()) answer.help = each.help;
  }
  return answer;
}

/// The `read` statements in a help, in their order.
std::vector<std::string> proposed_lines(std::string const& help) {
  std::vector<std::string> lines;
  for (std::size_t at = help.find("`read "); at != std::string::npos; at = help.find("`read ", at + 1))
    lines.push_back(help.substr(at + 1, help.find('`', at + 1) - at - 1));
  return lines;
}

/// Quietly missing samples included.
bool equal(std::vector<double> const& got, std::vector<double> const& wanted) {
  if (got.size() != wanted.size()) return false;
  for (std::size_t i = 0; i < got.size(); ++i)
    if (wanted[i] == none ? !std::isnan(got[i]) : !(std::fabs(got[i] - wanted[i]) <= 1e-12 * std::fabs(wanted[i]))) return false;
  return true;
}

}  // namespace

TEST_CASE("tables of loggers are read, or refused with the line to add, which then works") {
  for (LoggedTable const& table : tables) {
    CAPTURE(table.file);
    Answer answer = read(block_of(table, ""));
    std::string const first = answer.messages;
    CAPTURE(first);
    if (std::string(table.advice).empty()) {
      CHECK(answer.record);
    } else {
      CHECK_FALSE(answer.record);
      auto lines = proposed_lines(answer.help);
      if (static_cast<int>(lines.size()) <= table.choice) lines = proposed_lines(answer.messages);  // of all messages
      if (static_cast<int>(lines.size()) <= table.choice) {
        FAIL_CHECK("no line is proposed");
        continue;
      }
      std::string const line = lines[static_cast<std::size_t>(table.choice)];
      CHECK(line == table.advice);
      answer = read(block_of(table, line));
    }
    std::string const second = answer.messages;
    CAPTURE(second);
    CHECK(answer.record);
    if (!answer.record) continue;
    CHECK(equal(answer.record->time, table.seconds));
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      CAPTURE(table.columns[i].name);
      CHECK(equal(answer.record->measured[i], table.columns[i].values));
    }
  }
}
