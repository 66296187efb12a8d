// What could be read in two ways is asked about, and what is plain is not.
#include <doctest/doctest.h>

#include <cmath>

#include "core/text/diagnostic.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/unit_text.hpp"
#include "data/record.hpp"
#include "data/table/proposal.hpp"
#include "data/table/table.hpp"
#include "data/temporary_file.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

Table table_of(std::string bytes, ReadingRules const& rules = {}) {
  return Table::parse("run.csv", std::move(bytes), std::nullopt, 0, rules);
}

/// The message about a column, or one without a code.
Diagnostic said_about(std::string bytes, std::string const& column, ReadingRules const& rules = {}) {
  try {
    (void)table_of(std::move(bytes), rules).numbers(column);
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  return {};
}

bool has_part(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

/// 40 rows, of which row 20 is `odd`.
std::string rows_with(std::string const& odd) {
  std::string text = "t,y\n";
  for (int i = 0; i < 40; ++i) text += i == 20 ? odd + "\n" : std::to_string(i) + "," + std::to_string(i % 7) + ".5\n";
  return text;
}

}  // namespace

TEST_CASE("a large mark far above all samples is asked about, and a large sample among others is not") {
  for (char const* const mark : {"9999", "999", "99999", "7999", "32767", "1e20", "1e30", "9.9E37", "3.4028235e38", "9.91e37"}) {
    CAPTURE(mark);
    Diagnostic const asked = said_about(rows_with(std::string("20,") + mark), "y");
    CHECK(asked.code == "E4022");
    ReadingRules rules;
    rules.missing = {mark};
    rules.asked_for_missing = true;
    CHECK(std::isnan(table_of(rows_with(std::string("20,") + mark), rules).numbers("y")[20]));
  }
  // The line that is proposed does take the sample out.
  CHECK(has_part(said_about(rows_with("20,3.4028235e38"), "y").help, "3.4028235e+38"));
  CHECK(said_about("t,y\n0,990\n1,999\n2,980\n", "y").code.empty());
  CHECK(said_about("t,y\n0,0\n1,9999\n2,0\n3,9999\n", "y").code.empty());  // a switch
  CHECK(said_about("t,y\n0,1\n1,3\n2,70\n3,1000\n", "y").code.empty());
  CHECK(said_about("t,y\n0,1\n1,12\n2,170\n3,999\n", "y").code.empty());
}

TEST_CASE("a mark with a fraction is one in single precision, too") {
  for (double const mark : {99.9, -999.9, 999.25}) {
    std::vector<double> values(60, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.3 * static_cast<double>(i));
    values[7] = values[30] = static_cast<double>(static_cast<float>(mark));
    auto const found = doubtful_numbers(values);
    REQUIRE(found.size() == 1);
    CHECK(found[0].places == std::vector<std::size_t>{7, 30});
  }
  CHECK(doubtful_numbers({0.1, 0.2, 0.3, 99.87654, 0.2}).empty());
}

TEST_CASE("marks are judged by the samples that are none: two do not hide each other, and nines within the range are samples") {
  auto const of = [](std::vector<double> const& values) {
    std::vector<double> marks;
    for (DoubtfulNumber const& each : doubtful_numbers(values)) marks.push_back(each.value);
    return marks;
  };
  CHECK(of({1, 2, 3, -999, 9999, 2}) == std::vector<double>{-999, 9999});
  CHECK(of({0, 5000, 2500, -9999}) == std::vector<double>{-9999});
  CHECK(of({0.1, 0.2, 0.3, 99.9}) == std::vector<double>{99.9});
  CHECK(of({0.1, 0.2, 0.3, 0.999}).empty());
  CHECK(of({95, 98, 97, 99.9}).empty());
  CHECK(of({-15, 500, 20, -99.9}).empty());
  CHECK(of({0, 0, 999, 0}).empty());  // a blow on nothing
  CHECK(of({1, 2, 9876}).empty());
  CHECK(doubtful_numbers({1, 2, 9999, 3, 9999}).front().places == std::vector<std::size_t>{2, 4});
}

TEST_CASE("numbers that count from a date are recognised by size and steps, and seconds of a run are not") {
  auto const seems = [](std::vector<double> const& values, char const* column = "t") {
    SerialTime const* const found = seems_serial(values, column);
    return found == nullptr ? std::string() : std::string(found->word);
  };
  CHECK(seems({1709632800, 1709632801}) == "seconds");
  CHECK(seems({1709632800250., 1709632800500.}) == "milliseconds");
  CHECK(seems({1709632800250000000., 1709632800500000000.}) == "nanoseconds");
  CHECK(seems({45356.5, 45356.5 + 1 / 86400.0, 45356.5 + 2 / 86400.0}) == "days");
  CHECK(seems({739316.5, 739316.5 + 1 / 1440.0}) == "days");
  CHECK(seems({45356, 45357}, "Date") == "days");
  CHECK(seems({45356, 45357}).empty());  // seconds of a long run
  CHECK(seems({45356.5, 45356.52}).empty());
  CHECK(seems({0, 1}).empty());
}

TEST_CASE("an acceleration in g is in units of the standard gravity, a mass in grams") {
  Unit const acceleration = *unit_of_text("m/s^2"), mass = *unit_of_text("kg");
  for (char const* const written : {"g", "[g]", "G", "gn"}) {
    CAPTURE(written);
    REQUIRE(unit_of_text(written, acceleration));
    CHECK(unit_of_text(written, acceleration)->scale == 9.80665);  // CGPM 1901
  }
  for (char const* const written : {"mg", "[mG]", "milli-g"}) {
    CAPTURE(written);
    REQUIRE(unit_of_text(written, acceleration));
    CHECK(unit_of_text(written, acceleration)->scale == relative(9.80665e-3, 1e-15));
    CHECK(unit_atom(unit_of_text(written, acceleration)->text)->scale == unit_of_text(written, acceleration)->scale);
  }
  CHECK(unit_of_text("µg", acceleration)->scale == relative(9.80665e-6, 1e-15));
  CHECK(unit_of_text("g", mass)->scale == 1e-3);
  CHECK(unit_of_text("mg", mass)->scale == 1e-6);
  CHECK(unit_of_text("mm/s²", acceleration)->scale == 1e-3);
}

TEST_CASE("one point before three digits beside whole numbers is asked about where nothing decides") {
  CHECK(said_about("t;y\n0;950\n1;975\n2;1.001\n3;960\n", "y").code == "E4021");
  CHECK(said_about("t;y\n0;-950\n1;-1.050\n2;-990\n", "y").code == "E4021");
  CHECK(said_about("t,y,z\n0,950,\"0,25\"\n1,1.001,\"0,5\"\n", "y").code == "E4021");
  CHECK(said_about("t;y\n0;1.234\n1;1.345\n2;2.011\n", "y").code.empty());
  CHECK(said_about("t;y\n0;950\n1;1.001\n2;3.5\n", "y").code.empty());
  CHECK(said_about("t;y\n0.25;950\n0.5;1.001\n", "y").code.empty());
  CHECK(said_about("t,y\n0,950\n1,1.001\n2,960\n", "y").code.empty());
  ReadingRules german;
  german.decimal = ',';
  german.decimal_given = true;
  german.thousands = '.';
  CHECK(table_of("t;y\n0;950\n1;1.001\n", german).numbers("y")[1] == 1001);
  CHECK(said_about("t;y\n0;950\n1;0.500\n", "y", german).code == "E4010");
}

TEST_CASE("a broken row in the middle does not make half a record, and a footer is left out") {
  for (char const* const odd : {"ERR,ERR", "Reconnect", "--- buffer overrun, 3 samples lost ---"}) {
    CAPTURE(odd);
    CHECK_FALSE(propose(rows_with(odd), {}));
    CHECK(broken_line(rows_with(odd)) == 22);
  }
  std::string const footed = rows_with("20,1.5") + "end of record\n";
  CHECK(broken_line(footed) == 0);
  auto const proposal = propose(footed, {});
  REQUIRE(proposal);
  CHECK(proposal->rules.front().last_value == 41);
}

TEST_CASE("a word in a column of numbers is proposed as missing, also far below, and a number with its unit is not") {
  CHECK(has_part(said_about(rows_with("20,OVLD"), "y").help, "read missing = \"OVLD\""));
  CHECK_FALSE(has_part(said_about(rows_with("20,1.5 mm"), "y").help, "missing ="));
  std::string text = "t,y\n";
  for (int i = 0; i < 25000; ++i) text += std::to_string(i) + "," + (i == 24000 ? "OVLD" : std::to_string(i % 7) + ".5") + "\n";
  CHECK(has_part(said_about(text, "y").help, "read missing = \"OVLD\""));
}

TEST_CASE("a date with the day before the month is proposed as one, and no month as a zone") {
  auto const proposal = propose("time,y\n2024-13-04,1.5\n2024-14-05,2.25\n2024-15-06,3\n", {}, {.time = "time"});
  REQUIRE(proposal);
  CHECK(proposal->rules.size() == 1);
  CHECK(proposal->rules.front().stamp == "YYYY-DD-MM");
  auto const days = propose("time,y\n2024-133 10:00:00,1.5\n2024-134 10:00:00,2.25\n", {}, {.time = "time"});
  REQUIRE(days);
  CHECK(days->rules.front().stamp == "YYYY-DDD hh:mm:ss");
}

TEST_CASE("a mark is compared as a number in the notation of the file, and proposed in it") {
  ReadingRules rules;
  rules.decimal = ',';
  rules.decimal_given = true;
  Diagnostic const asked = said_about("t;y\n0;1,5\n1;-99,90\n2;1,25\n", "y", rules);
  CHECK(asked.code == "E4022");
  CHECK(has_part(asked.help, "missing = \"-99,9\""));
  for (char const* const mark : {"-99,9", "-99,90", "-99.9"}) {
    CAPTURE(mark);
    rules.missing = {mark};
    rules.asked_for_missing = true;
    std::vector<double> const values = table_of("t;y\n0;1,5\n1;-99,90\n2;1,25\n", rules).numbers("y");
    CHECK((values[0] == 1.5 && std::isnan(values[1]) && values[2] == 1.25));
  }
  // With groups of digits the word is read as the cell is.
  rules.thousands = '.';
  rules.missing = {"-9.999"};
  std::vector<double> const grouped = table_of("t;y\n0;-9,999\n1;-9.999\n2;-9999\n", rules).numbers("y");
  CHECK((grouped[0] == -9.999 && std::isnan(grouped[1]) && std::isnan(grouped[2])));
}

TEST_CASE("the line about a cell that is no number names columns that are there twice, and works") {
  TemporaryFile const file("logger 7\nt;y;y;z\n0;1,5;2,5;1\n1;1,25;2,25;1\n2;1,75;2,75;1\n");
  RecordRequest wanted;
  wanted.path = file.path();
  wanted.time = ColumnRequest{"t", std::nullopt, std::nullopt, std::nullopt};
  wanted.measured.push_back(ColumnRequest{"y", std::nullopt, std::nullopt, std::nullopt});
  Diagnostics diagnostics;
  CHECK_FALSE(load(wanted, diagnostics));
  std::string const help = diagnostics.all().front().help;
  CHECK(has_part(help, "columns = (\"t\", \"y\", \"y_2\", \"z\")"));
  // A block that reads none of them needs no names.
  wanted.measured.front()->column = "z";
  Diagnostics others;
  CHECK_FALSE(load(wanted, others));
  CHECK_FALSE(has_part(others.all().front().help, "columns ="));
  wanted.measured.front()->column = "y";
  auto const proposal = propose("logger 7\nt;y;y;z\n0;1,5;2,5;1\n1;1,25;2,25;1\n2;1,75;2,75;1\n", {}, {});
  REQUIRE(proposal);
  wanted.rules = proposal->rules.front();
  wanted.rules.columns = {"t", "y", "y_2", "z"};
  Diagnostics none;
  auto const record = load(wanted, none);
  REQUIRE(record);
  CHECK(record->measured[0] == std::vector<double>{1.5, 1.25, 1.75});
}
