// What a message says to write is written, and then the record is read: numbers as they stand in files of loggers.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "data/look/record_look.hpp"
#include "data/record.hpp"
#include "data/temporary_file.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

struct Followed {
  std::optional<Record> record;
  std::string code, message, help;  // of the first message
};

/// lines: of the data block, besides `file`, `time t` and `measure y = y`.
Followed answer_to(std::string const& path, std::string const& lines, std::string const& time = "time t") {
  Followed answer;
  Diagnostics diagnostics;
  Source source("followed.sysid", fmt::format("data d {{\n  file \"{}\"\n  {}\n  {}\n  measure y = y\n}}\n", path, lines, time));
  if (auto const file = load(source, diagnostics)) {
    DataBlock const& block = file->data.at(0);
    RecordRequest request;
    request.path = block.path;
    request.rules = block.rules;
    request.time = ColumnRequest{block.time->column, block.time->unit, std::nullopt, block.time->span};
    request.measured = {ColumnRequest{"y", {}, {}, {}}};
    answer.record = sysid::load(request, diagnostics);
  }
  if (!diagnostics.all().empty()) {
    Diagnostic const& first = diagnostics.all().front();
    answer.code = first.code, answer.message = first.message, answer.help = first.help;
  }
  return answer;
}

/// The statement in a help that begins so.
std::string statement_in(std::string const& help, std::string const& begin, int number = 0) {
  std::size_t at = help.find("`" + begin);
  for (; number > 0 && at != std::string::npos; --number) at = help.find("`" + begin, at + 1);
  return at == std::string::npos ? std::string() : help.substr(at + 1, help.find('`', at + 1) - at - 1);
}

std::string rows_with_word(std::string const& odd) {
  std::string text = "t,y\n";
  for (int i = 0; i < 40; ++i) text += fmt::format("{},{}\n", i, i == 20 ? odd : fmt::format("{}.5", i % 7));
  return text;
}

}  // namespace

TEST_CASE("a word `none` for a missing sample is a word in quotes, and the bare word says that no number is a mark") {
  TemporaryFile const word(rows_with_word("none")), mark(rows_with_word("-9999"));
  Followed const first = answer_to(word.path(), "");
  std::string const line = statement_in(first.help, "read ");
  CHECK(line == "read missing = \"none\"");
  Followed const second = answer_to(word.path(), line);
  REQUIRE(second.record);
  CHECK(std::isnan(second.record->measured[0][20]));
  // Beside the bare word.
  Followed const other = answer_to(word.path(), "read missing = none");
  CHECK(other.code == "E4010");
  std::string const both = statement_in(other.help, "read ");
  CHECK(both == "read missing = (\"none\", none)");
  CHECK(answer_to(word.path(), both).record);
  CHECK(answer_to(mark.path(), "read missing = none").record->measured[0][20] == -9999);
}

TEST_CASE("a column of dates goes with a pattern, and not with a count since a date") {
  TemporaryFile const file("D,t,y\n2024-05-01,10:00:00,1\n2024-05-02,10:01:00,2\n2024-05-03,10:02:00,3\n");
  for (char const* const stamp : {"seconds", "days"}) {
    Followed const refused = answer_to(file.path(), fmt::format("read stamp = {}, date = \"D\"", stamp));
    CHECK(refused.code == "E4118");
    CHECK(refused.message.find("`date`") != std::string::npos);
  }
  Followed const read = answer_to(file.path(), "read stamp = \"YYYY-MM-DD hh:mm:ss\", date = \"D\"");
  REQUIRE(read.record);
  CHECK(read.record->time == std::vector<double>{0, 86460, 172920});
}

TEST_CASE("numbers as numpy.savetxt prints them are looked at, asked about and read") {
  std::string text = "t,y\n";
  for (int i = 0; i < 30; ++i) text += fmt::format("{:.18e},{:.18e}\n", 1714500000.0 + 60 * i, 0.1 * (i % 3));
  TemporaryFile const file(text);
  Followed const first = answer_to(file.path(), "");
  CHECK(first.code == "E4029");
  Followed const second = answer_to(file.path(), statement_in(first.help, "read "));
  REQUIRE(second.record);
  CHECK(second.record->time[29] == 29 * 60);
  RecordLook const look = look_at_record(file.path());
  CHECK(look.reading == "read stamp = seconds");
  CHECK(look.time.step == 60);
}

TEST_CASE("the rate of a record is that of its clock, not of its last digits") {
  std::string plain = "t,y\n", days = "Date,y\n", off = plain;
  for (int i = 0; i < 400; ++i) {
    plain += fmt::format("{:.5f},{}\n", i / 128.0, i % 3);
    days += fmt::format("{:.10f},{}\n", 45356.5 + i / 128.0 / 86400, i % 3);
    off += fmt::format("{:.5f},{}\n", i / 128.0 + (i % 5 == 0 ? 1e-3 : 0), i % 3);
  }
  for (std::string const& text : {plain, days}) {
    TemporaryFile const file(text);
    TimeLook const time = look_at_record(file.path()).time;
    CHECK(std::fabs(1 / time.step - 128) < 1e-3);
    CHECK(time.unequal == 0);
  }
  TemporaryFile const file(off);
  CHECK(look_at_record(file.path()).time.unequal > 100);
}

TEST_CASE("durations in the column of times are read with the line that the message gives") {
  TemporaryFile const file("t,y\n0.00 s,0.5\n0.01 s,1.5\n0.02 s,2.5\n");
  Followed const asked = answer_to(file.path(), "");
  CHECK(asked.code == "E4010");
  CHECK(answer_to(file.path(), statement_in(asked.help, "read ")).record->time[2] == 0.02);
  TemporaryFile const units("t,y\n0.00 s,0.5 mm\n0.01 s,1.5 mm\n0.02 s,2.5 mm\n");
  Followed const first = answer_to(units.path(), "");
  CHECK(statement_in(first.help, "read ") == "read stamp = duration");
  CHECK(answer_to(units.path(), "read stamp = duration").help.find("`y [mm]`") != std::string::npos);
}

TEST_CASE("a file that ends within a line is read with the line that the message gives") {
  TemporaryFile const file("t,x,y\n0,1,0.5\n1,1,1.5\n2,1,2.5\n3,1");
  Followed const asked = answer_to(file.path(), "");
  CHECK(asked.code == "E4005");
  CHECK(answer_to(file.path(), statement_in(asked.help, "read ")).record->rows() == 3);
}

TEST_CASE("frames are no fraction of a second: nothing is proposed that would read them so") {
  TemporaryFile const file("t,y\n10:00:00:00,1\n10:00:00:01,2\n10:00:00:23,3\n10:00:01:00,4\n");
  Followed const asked = answer_to(file.path(), "");
  CHECK(asked.help.find("frames") != std::string::npos);
}

TEST_CASE("dates that begin with the year or the day are asked about, the likelier order first") {
  TemporaryFile const file("t,y\n24.05.01 00:00:00,1\n24.05.01 12:00:00,2\n24.05.02 00:00:00,3\n24.05.02 12:00:00,4\n");
  Followed const asked = answer_to(file.path(), "");
  CHECK(asked.help.find("may have the day or the year first") != std::string::npos);
  Followed const read = answer_to(file.path(), statement_in(asked.help, "read "));
  REQUIRE(read.record);
  CHECK(read.record->time == std::vector<double>{0, 43200, 86400, 129600});
}
