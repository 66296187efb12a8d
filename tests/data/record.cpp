// Records: units at the boundary, times, gaps, and the experiments cut from them.
#include "data/record.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "data/record_rows.hpp"
#include "data/table/table.hpp"
#include "data/table_record.hpp"
#include "relative.hpp"
#include "temporary_file.hpp"

using namespace sysid;

namespace {

Unit atom(std::string_view name) { return unit_atom(name).value(); }

ColumnRequest column(std::string name, std::optional<Unit> unit = {}, std::optional<Unit> declared = {}) {
  return {std::move(name), std::move(unit), std::move(declared), std::nullopt};
}

InputRequest input(std::string name, InputRule rule) { return {column(std::move(name)), rule}; }

/// Time column t, inputs and measured columns as they stand.
RecordRequest request(std::string path, std::vector<InputRequest> inputs, std::vector<std::string> measured) {
  RecordRequest result;
  result.path = std::move(path);
  result.time = column("t");
  result.inputs = std::move(inputs);
  for (std::string& name : measured) result.measured.push_back(column(std::move(name)));
  return result;
}

Record loaded(RecordRequest const& request) {
  Diagnostics diagnostics;
  std::optional<Record> record = load(request, diagnostics);
  for (Diagnostic const& diagnostic : diagnostics.all()) MESSAGE(diagnostic.message);
  REQUIRE(record);
  return std::move(*record);
}

std::vector<Diagnostic> errors(RecordRequest const& request) {
  Diagnostics diagnostics;
  CHECK_FALSE(load(request, diagnostics));
  return diagnostics.all();
}

}  // namespace

TEST_CASE("a record has time, inputs and channels in the order asked for") {
  TemporaryFile const file("y2,t,x,y1\n10,0,1,20\n11,0.5,2,21\n12,2,3,22\n");
  RecordRequest wanted = request(file.path(), {input("x", InputRule::linear)}, {"y1", "y2"});
  wanted.measured.insert(wanted.measured.begin() + 1, std::nullopt);
  Record const record = loaded(wanted);
  CHECK(record.rows() == 3);
  CHECK(record.time == std::vector<double>{0, 0.5, 2});
  CHECK(record.inputs[0].value(1, 0.5) == 2.5);
  CHECK(record.measured[0] == std::vector<double>{20, 21, 22});
  CHECK(record.measured[1].empty());
  CHECK(record.measured[2] == std::vector<double>{10, 11, 12});
  CHECK(record.path == file.path());
  CHECK(record.digest.size() == 64);
}

TEST_CASE("numbers are converted from the column's unit to the model's, then to SI") {
  TemporaryFile const file("t,a\n0,100\n1000,200\n");
  struct Row {
    std::optional<Unit> unit, declared;
    double first;
  };
  Unit const mm = atom("mm"), m = atom("m"), cm = atom("cm");
  Row const rows[] = {{mm, m, 0.1},
                      {mm, cm, 0.1},
                      {std::nullopt, mm, 0.1},
                      {mm, std::nullopt, 0.1},
                      {std::nullopt, std::nullopt, 100},
                      // Temperatures enter equations as degrees above the zero of the declared unit.
                      {atom("degC"), atom("degC"), 100},
                      {atom("degC"), atom("K"), 373.15},
                      {atom("K"), atom("degC"), 100 - 273.15},
                      {atom("degF"), atom("degC"), (100 - 32) / 1.8}};
  for (Row const& row : rows) {
    RecordRequest wanted;
    wanted.path = file.path();
    wanted.time = column("t", atom("ms"), atom("s"));
    wanted.measured = {column("a", row.unit, row.declared)};
    wanted.inputs = {InputRequest{column("a", row.unit, row.declared), InputRule::zero_order}};
    Record const record = loaded(wanted);
    CHECK(record.time[1] == 1);
    CHECK(record.measured[0][0] == relative(row.first, 1e-13));
    CHECK(record.inputs[0].sample(0) == record.measured[0][0]);
  }
}

TEST_CASE("hertz are not converted to radians per second") {
  TemporaryFile const file("t,w\n0,1\n1,2\n");
  RecordRequest wanted = request(file.path(), {}, {});
  wanted.measured = {column("w", atom("Hz"), divide(atom("rad"), atom("s")))};
  std::vector<Diagnostic> const found = errors(wanted);
  REQUIRE(found.size() == 1);
  CHECK(found[0].code == "E4017");
}

TEST_CASE("without a time column rows are equally spaced from zero, without drift") {
  std::string text = "y\n";
  for (int i = 0; i < 1001; ++i) text += "1\n";
  TemporaryFile const file(text);
  RecordRequest wanted;
  wanted.path = file.path();
  wanted.step = 0.1;
  wanted.measured = {column("y")};
  Record const record = loaded(wanted);
  CHECK(record.time.front() == 0);
  CHECK(record.time.back() == 1000 * 0.1);
}

TEST_CASE("time must increase from row to row") {
  for (char const* third : {"1", "0.5"}) {
    TemporaryFile const file(std::string("# lab\nt,y\n0,1\n1,1\n") + third + ",1\n");
    std::vector<Diagnostic> const found = errors(request(file.path(), {}, {"y"}));
    REQUIRE(found.size() == 1);
    CHECK(found[0].code == "E4014");
    CHECK(found[0].message.find("row 3 (line 5), column `t`") != std::string::npos);
  }
}

TEST_CASE("times that do not increase are shown as the file has them") {
  TemporaryFile const file("t,y\n7.27,1\n4.82,1\n");
  RecordRequest wanted = request(file.path(), {}, {"y"});
  wanted.time->unit = unit_atom("h");
  std::vector<Diagnostic> const found = errors(wanted);
  REQUIRE(found.size() == 1);
  CHECK(found[0].message.ends_with("4.82 h comes after 7.27 h"));
}

TEST_CASE("samples may be missing in measured columns only") {
  TemporaryFile const file("t,x,y\n0,1,\n1,2,5\n2,NA,NA\n");
  Record const record = loaded(request(file.path(), {}, {"y"}));
  CHECK(std::isnan(record.measured[0][0]));
  CHECK(record.measured[0][1] == 5);
  CHECK(std::isnan(record.measured[0][2]));
  TemporaryFile const empty("t,x,y\n0,,1\n1,NA,5\n2,,6\n");
  std::vector<Diagnostic> const found = errors(request(empty.path(), {input("x", InputRule::zero_order)}, {"y"}));
  REQUIRE(found.size() == 1);
  CHECK(found[0].code == "E4013");
  CHECK(found[0].message == "`" + empty.path() + "` row 1 (line 2), column `x` has no value, but an input needs one in every row");
  TemporaryFile const gap("t,y\n0,1\n,2\n");
  CHECK(errors(request(gap.path(), {}, {"y"})).at(0).code == "E4013");
}

namespace {

/// 200 rows of a sine, of which `from`..`to` lack the input.
std::string with_gap(int from, int to) {
  std::string text = "t,x,y\n";
  for (int row = 1; row <= 200; ++row)
    text += row >= from && row <= to ? fmt::format("{},,1\n", row) : fmt::format("{},{},1\n", row, row % 7);
  return text;
}

Diagnostic refused_rows(Record const& record, int from, RowRange rows, int earlier = 0) {
  try {
    (void)make_experiment(record, "bench", from, rows, std::nullopt, earlier);
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  return {};
}

}  // namespace

TEST_CASE("a gap of an input is refused where the rows of a run, or what its rule reads around them, have it, and nowhere else") {
  TemporaryFile const file(with_gap(100, 101));
  struct Case {
    InputRule rule;
    int around;
  };
  for (Case const& each : {Case{InputRule::zero_order, 0}, Case{InputRule::linear, 0}, Case{InputRule::cubic, 20},
                           Case{InputRule::band_limited, 40}}) {
    CAPTURE(each.around);
    Record const record = loaded(request(file.path(), {input("x", each.rule)}, {"y"}));
    CHECK(refused_rows(record, 1, {1, 99 - each.around}).code.empty());
    CHECK(refused_rows(record, 102 + each.around, {102 + each.around, 200}).code.empty());
    for (RowRange const rows : {RowRange{1, 100 - each.around}, RowRange{101 + each.around, 200}, RowRange{50, 150}}) {
      Diagnostic const said = refused_rows(record, rows.first, rows);
      CHECK(said.code == "E4013");
      CHECK(said.message.find("row 100 (line 101), column `x` has no values up to row 101 (2 rows)") != std::string::npos);
    }
  }
  // The rows before those that are simulated: a simulation from the record's first row, samples that a model looks back to.
  Record const record = loaded(request(file.path(), {input("x", InputRule::zero_order)}, {"y"}));
  CHECK(refused_rows(record, 1, {150, 200}).code == "E4013");
  CHECK(refused_rows(record, 103, {103, 200}, 1).code.empty());
  CHECK(refused_rows(record, 103, {103, 200}, 2).code == "E4013");
}

TEST_CASE("values outside a gap are those of a record without it, to what a run could show") {
  TemporaryFile const with(with_gap(100, 101)), without(with_gap(0, 0));
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic}) {
    Experiment const a = make_experiment(loaded(request(with.path(), {input("x", rule)}, {"y"})), "bench", 122, {122, 200});
    Experiment const b = make_experiment(loaded(request(without.path(), {input("x", rule)}, {"y"})), "bench", 122, {122, 200});
    for (int i = 0; i < 78; ++i) CHECK(a.inputs[0].value(i, 0.4) == doctest::Approx(b.inputs[0].value(i, 0.4)).epsilon(1e-9));
  }
}

TEST_CASE("the message about a gap names how to fill a short one, and the longest rows without it") {
  TemporaryFile const brief(with_gap(100, 101)), longer(with_gap(60, 120));
  Record const record = loaded(request(brief.path(), {input("x", InputRule::zero_order)}, {"y"}));
  CHECK(refused_rows(record, 1, {1, 200}).help ==
        "fill the gap in the file with numbers between its neighbours, which are 1 and 4, or use rows without it: `split part = "
        "rows 1..99`");
  CHECK(
      refused_rows(record, 90, {90, 200}).help ==
      "fill the gap in the file with numbers between its neighbours, which are 1 and 4, or use rows without it: `split part = rows "
      "102..200` with `start = estimated(rows = 49)` in the task, or with `start = rest` if nothing moved just before row 102");
  std::string const far =
      refused_rows(loaded(request(longer.path(), {input("x", InputRule::zero_order)}, {"y"})), 1, {1, 200}).help;
  CHECK(far.find("neighbours") == std::string::npos);
  CHECK(far.find("rows 121..200") != std::string::npos);
}

TEST_CASE("a column whose name has another unit than the model is not read in that of the model") {
  TemporaryFile const file("t,a_z [mg],F [kN],u (V)\n0,1000,1,2\n1,1001,2,3\n");
  Unit const acceleration = divide(atom("m"), power(atom("s"), {2, 1}));
  auto const ask = [&](std::string name, std::optional<Unit> unit, std::optional<Unit> declared) {
    RecordRequest wanted = request(file.path(), {}, {});
    wanted.measured.push_back(column(std::move(name), std::move(unit), std::move(declared)));
    return wanted;
  };
  Diagnostic const said = errors(ask("a_z [mg]", {}, acceleration)).at(0);
  CHECK(said.code == "E4026");
  CHECK(said.help.find("`[mg_n]`") != std::string::npos);
  CHECK(errors(ask("a_z [mg]", acceleration, acceleration)).at(0).help.find("`[mg_n]`") != std::string::npos);
  CHECK(errors(ask("F [kN]", {}, atom("N"))).at(0).code == "E4026");
  CHECK(loaded(ask("a_z [mg]", atom("mg_n"), acceleration)).measured[0][0] == doctest::Approx(9.80665));
  CHECK(loaded(ask("F [kN]", atom("kN"), atom("N"))).measured[0][0] == 1000);
  CHECK(loaded(ask("F [kN]", {}, atom("kN"))).measured[0][0] == 1000);
  CHECK(loaded(ask("u (V)", {}, atom("N"))).measured[0][0] == 2);  // of another kind: it may be no unit
}

TEST_CASE("several wrong columns are reported together, each at its mention") {
  TemporaryFile const file("t,x,y\n0,1,nan\n0,2,3\n");
  RecordRequest wanted = request(file.path(), {input("force", InputRule::cubic)}, {"y", "z"});
  wanted.time->mention = Span{1, 2};
  wanted.inputs[0].mention = Span{3, 4};
  wanted.measured[0]->mention = Span{5, 6};
  wanted.measured[1]->mention = Span{7, 8};
  std::vector<Diagnostic> const found = errors(wanted);
  REQUIRE(found.size() == 4);
  std::string codes;
  for (Diagnostic const& diagnostic : found) codes += diagnostic.code + " ";
  CHECK(codes == "E4014 E4008 E4011 E4008 ");
  for (std::size_t i = 0; i < 4; ++i) CHECK(found[i].primary->span.begin == 2 * i + 1);
}

TEST_CASE("a mistake of the input rule points to the input") {
  TemporaryFile const file("t,x\n0,1\n1,2\n3,4\n");
  RecordRequest wanted = request(file.path(), {input("x", InputRule::band_limited)}, {});
  wanted.inputs[0].mention = Span{3, 4};
  std::vector<Diagnostic> const found = errors(wanted);
  REQUIRE(found.size() == 1);
  CHECK(found[0].code == "E4015");
  CHECK(found[0].primary->span == Span{3, 4});
}

TEST_CASE("times of a file that are equal before they were rounded are read as equal, in the unit of the column") {
  std::string text = "t,y\n";
  for (int i = 0; i < 60; ++i) text += fmt::format("{:.7g},{}\n", i * 1000.0 / 59, i);
  TemporaryFile const file(text);
  RecordRequest wanted = request(file.path(), {}, {"y"});
  wanted.time = column("t", Unit{.dimension = atom("s").dimension, .scale = 1e-3, .text = "ms"});
  Record const record = loaded(wanted);
  CHECK(unequal_step(record.time) == 0);
  CHECK(record.time.back() == doctest::Approx(1).epsilon(1e-6));
  // Rows that arrive one after the other keep their times.
  Diagnostics diagnostics;
  auto const arrived = read_record(wanted, Table::read(file.path()), diagnostics);
  REQUIRE(arrived);
  CHECK(unequal_step(arrived->time) > 0);
}

TEST_CASE("a record needs two rows") {
  for (char const* text : {"t,y\n", "t,y\n0,1\n"}) {
    TemporaryFile const file(text);
    CHECK(errors(request(file.path(), {}, {"y"})).at(0).code == "E4007");
  }
}

TEST_CASE("a missing file is an I/O error") {
  Diagnostics diagnostics;
  CHECK_THROWS_AS(load(request("/nonexistent/run.csv", {}, {}), diagnostics), IoError);
}

TEST_CASE("an experiment scores its rows and simulates from the row it is told to") {
  TemporaryFile const file("t,x,y\n0,1,10\n1,4,11\n2,9,\n3,16,13\n4,25,14\n5,36,15\n");
  Record const record = loaded(request(file.path(), {input("x", InputRule::cubic)}, {"y"}));

  Experiment const whole = make_experiment(record, "bench", 1, {3, 5});
  CHECK(whole.name == "bench");
  CHECK(whole.first_row == 1);
  CHECK(whole.time == std::vector<double>{0, 1, 2, 3, 4});
  CHECK(whole.scored == std::vector<std::uint8_t>{0, 0, 1, 1, 1});
  CHECK(whole.measured[0].size() == 5);
  CHECK(std::isnan(whole.measured[0][2]));
  CHECK(whole.inputs[0].rows() == 5);

  Experiment const rest = make_experiment(record, "bench", 3, {3, 5});
  CHECK(rest.first_row == 3);
  CHECK(rest.time == std::vector<double>{2, 3, 4});
  CHECK(rest.scored == std::vector<std::uint8_t>{1, 1, 1});
  CHECK(rest.measured[0][1] == 13);
  // The spline through the whole record, (t + 1)^2, not one that ends at the split.
  CHECK(rest.inputs[0].value(0, 0.5) == doctest::Approx(3.5 * 3.5).epsilon(1e-14));

  CHECK(make_experiment(record, "bench", 1, {}).scored.size() == 6);
}

TEST_CASE("rows outside the record are an error that names how many there are") {
  TemporaryFile const file("t,y\n0,1\n1,2\n2,3\n");
  Record const record = loaded(request(file.path(), {}, {"y"}));
  CHECK_FALSE(check_rows(record, "range `train`", {1, 3}));
  CHECK_FALSE(check_rows(record, "range `train`", {}));
  std::optional<Diagnostic> const wrong = check_rows(record, "range `train`", {1, 4}, Span{1, 2});
  REQUIRE(wrong);
  CHECK(wrong->code == "E4016");
  CHECK(wrong->message == "range `train` selects rows 1..4, but `" + file.path() + "` has 3 rows");
  CHECK(wrong->primary->span == Span{1, 2});
  CHECK(check_rows(record, "range `train`", {0, 2}));
  CHECK(check_rows(record, "range `train`", {3, 2}));
  CHECK_THROWS_AS(make_experiment(record, "bench", 1, {2, 4}), UserError);
  CHECK_THROWS_AS(make_experiment(record, "bench", 3, {2, 3}), InternalError);
}

TEST_CASE("an experiment without the channel in its data has no samples of it") {
  TemporaryFile const file("t,y\n0,1\n1,2\n");
  RecordRequest wanted = request(file.path(), {}, {"y"});
  wanted.measured.push_back(std::nullopt);
  Experiment const experiment = make_experiment(loaded(wanted), "bench", 1, {});
  CHECK(experiment.measured[0].size() == 2);
  CHECK(experiment.measured[1].empty());
}

TEST_CASE("a unit in the name of a column goes against another one of the data block") {
  TemporaryFile const file("t,F [kN],sensor (A),T (C),x in mm,acc (g)\n0,1,2,3,4,1\n1,2,3,4,5,2\n");
  auto const with = [&](std::string name, std::string_view unit) {
    RecordRequest wanted = request(file.path(), {}, {});
    wanted.measured.push_back(column(std::move(name), atom(unit), atom(unit)));
    return wanted;
  };
  auto const refused = errors(with("F [kN]", "N"));
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].code == "E4026");
  for (char const* const cure : {"`[kN]`", "read units = names", "`F` without a unit", "read columns"}) {
    CAPTURE(cure);
    CHECK(refused[0].help.find(cure) != std::string::npos);
  }
  CHECK(errors(with("F [kN]", "m")).size() == 1);
  CHECK(errors(with("x in mm", "m")).size() == 1);
  CHECK(loaded(with("F [kN]", "kN")).measured[0][1] == 2000);
  CHECK(loaded(with("sensor (A)", "V")).measured[0][1] == 3);
  CHECK(loaded(with("T (C)", "degC")).rows() == 2);
  CHECK(errors(with("T (C)", "K")).at(0).help.find("`[degC]`") != std::string::npos);
  CHECK(loaded(with("acc (g)", "g_n")).rows() == 2);
  CHECK(loaded(request(file.path(), {}, {"F [kN]"})).measured[0][1] == 2);
}

TEST_CASE("times of independent rows that are no seconds are refused where the model reads them") {
  TemporaryFile const days("t,y\n46166.5000001157,1\n46166.5,2\n46166.5000002315,3\n"), counts("RECORD,y\n1,1\n2,2\n3,3\n");
  for (bool const reads : {false, true}) {
    CAPTURE(reads);
    RecordRequest wanted = request(days.path(), {}, {"y"});
    wanted.independent_rows = true;
    wanted.uses_times = reads;
    RecordRequest counted = request(counts.path(), {}, {"y"});
    counted.time = column("RECORD");
    counted.independent_rows = true;
    counted.uses_times = reads;
    if (reads) {
      CHECK(errors(wanted).at(0).code == "E4029");
      CHECK(errors(counted).at(0).code == "E4029");
    } else {
      CHECK(loaded(wanted).rows() == 3);
      CHECK(loaded(counted).rows() == 3);
    }
  }
}

TEST_CASE("who states seconds means seconds, unless they would be older than the earth") {
  auto const file_of = [](double first, double step) {
    std::string text = "t,y\n";
    for (int i = 0; i < 30; ++i) text += fmt::format("{},{}\n", first + i * step, i % 5);
    return text;
  };
  TemporaryFile const days(file_of(45356.5, 1.0 / 86400)), milliseconds(file_of(1.7145e12, 1000));
  RecordRequest wanted = request(days.path(), {}, {"y"});
  std::vector<Diagnostic> const asked = errors(wanted);
  CHECK(asked.at(0).code == "E4029");
  CHECK(asked.at(0).help.find("`time t [s]`") != std::string::npos);
  wanted.time->unit = atom("s");
  CHECK(loaded(wanted).time[0] == 45356.5);
  wanted = request(milliseconds.path(), {}, {"y"});
  wanted.time->unit = atom("s");
  CHECK(errors(wanted).at(0).code == "E4029");
  wanted.time->unit = atom("ms");
  CHECK(loaded(wanted).time[1] - loaded(wanted).time[0] == 1);
}
