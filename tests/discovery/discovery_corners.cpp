// What may go wrong with a dictionary and a record, each through the whole program: one message with a code, a place where the text
// has one, and the exit code that belongs to it.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/numeric/random.hpp"
#include "discovery/discovering.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;
using json = nlohmann::json;

namespace {

std::string const record = Made(900).csv();

DiscoveryAnswer run(std::string const& text, std::string const& csv = record) { return run_with(text, {{"bench.csv", csv}}); }

/// The record with column `column` of row `row` (from 0) replaced.
std::string replaced(std::size_t row, int column, std::string const& value) {
  std::size_t begin = record.find('\n') + 1;
  for (std::size_t i = 0; i < row; ++i) begin = record.find('\n', begin) + 1;
  for (int i = 0; i < column; ++i) begin = record.find(',', begin) + 1;
  std::string text = record;
  text.replace(begin, record.find_first_of(",\n", begin) - begin, value);
  return text;
}

}  // namespace

TEST_CASE("the record that the corner cases vary is found without a word") {
  DiscoveryAnswer const answer = run(file(oscillator));
  CHECK(answer.exit == 0);
  CHECK(answer.kept() == Texts{"y'", "y", "y^3"});
  CHECK(answer.codes().empty());
}

TEST_CASE("a forcing that the dictionary declares and does not read is named where it stands") {
  DiscoveryAnswer const answer = run(file("target = y''\nterms = y', y, y^2, y^3, 1"));
  CHECK(answer.exit == 0);
  CHECK(contains(answer.said, "case.sysid:2:7: warning[E3019]: nothing in this dictionary uses the input `u`"));
  json const finding = answer.finding("unexplained_residual");
  REQUIRE_FALSE(finding.is_null());
  CHECK(finding.at("severity") == "warning");
}

TEST_CASE("a forcing that the data hold and the dictionary does not declare is named where it stands") {
  std::string text = file("target = y''\nterms = y', y, y^2, y^3, 1");
  text = without(text, "input u [N]\n");
  DiscoveryAnswer const answer = run(text);
  CHECK(answer.exit == 65);
  CHECK(contains(answer.said, "error[E4115]: dictionary `terms` has no input `u`"));
}

TEST_CASE("a forcing that was not recorded, and a term that the dictionary lacks, are missed in the residual") {
  std::string text = without(file("target = y''\nterms = y', y, y^2, y^3, 1", "seed = 1", ""), "input u [N]\n");
  DiscoveryAnswer const forcing = run(text);
  CHECK(forcing.exit == 0);
  REQUIRE_FALSE(forcing.finding("unexplained_residual").is_null());
  CHECK(contains(forcing.finding("unexplained_residual").at("message"), "an input or a term is missing"));
  DiscoveryAnswer const term = run(file("target = u - 1 [kg]*y''\nterms = y', y, y^2, 1"));
  CHECK_FALSE(term.finding("unexplained_residual").is_null());
}

TEST_CASE("an input read under the wrong rule between its samples is named with the right one, in every form") {
  std::string const held = "input u = u [N] hold zero_order; ", lines = "input u = u [N] hold linear; ";
  std::string const quiet = Made(900, {.noise = 2e-4}).csv();
  for (std::string const form : {"weak", "central", "savitzky_golay"}) {
    CAPTURE(form);
    std::string const options = "spike_slab(derivatives = " + form + "), seed = 1";
    DiscoveryAnswer const right = run(file(oscillator, options, held), quiet), wrong = run(file(oscillator, options, lines), quiet);
    CHECK(right.finding("input_rule").is_null());
    REQUIRE_FALSE(wrong.finding("input_rule").is_null());
    CHECK(wrong.finding("input_rule").at("names") == json{"u", "zero_order"});
  }
}

TEST_CASE("the rule that is replaced is the one of the record that has another") {
  std::string const quiet = Made(900, {.noise = 2e-4}).csv();
  std::string text = file(oscillator, "seed = 1", "input u = u [N] hold zero_order; ");
  text.insert(text.find("data bench"),
              "data other { file \"bench.csv\"; time t [s]; input u = u [N] hold linear; measure displacement = y [m] }\n");
  text.replace(text.find("from bench"), 10, "from bench, other");
  json const found = run(text, quiet).finding("input_rule");
  REQUIRE_FALSE(found.is_null());
  CHECK_MESSAGE(contains(found.at("message"), "`hold zero_order` in place of `hold linear`"), found.dump());
}

TEST_CASE("a forcing that was not recorded is missed by forms on samples too, and nothing is where all is there") {
  std::string const without_force = without(
      file("target = y''\nterms = y', y, y^2, y^3, 1", "spike_slab(derivatives = savitzky_golay), seed = 1", ""), "input u [N]\n");
  json const finding = run(without_force).finding("unexplained_residual");
  REQUIRE_FALSE(finding.is_null());
  CHECK(contains(finding.at("message"), "or the derivatives are not accurate"));
  CHECK(run(file(oscillator, "spike_slab(derivatives = savitzky_golay), seed = 1")).finding("unexplained_residual").is_null());
}

TEST_CASE("terms that are one on this record are named, and the first stays") {
  DiscoveryAnswer const repeats = run(file("target = u - 1 [kg]*y''\nterms = y', y, y^3, abs(y)*sign(y)"));
  CHECK(repeats.exit == 0);
  CHECK(repeats.kept() == Texts{"y'", "y", "y^3"});
  CHECK(contains(repeats.finding("terms_repeat").at("message"), "`abs(y)*sign(y)` is a multiple of `y`"));
  DiscoveryAnswer const sum =
      run(file("let angle = y/1 [m]\ntarget = u - 1 [kg]*y''\nterms = y', y, y^3, sin(angle)^2, 1, cos(angle)^2"));
  CHECK(sum.exit == 0);
  CHECK(contains(sum.finding("terms_collinear").at("message"), "`cos(angle)^2` is a linear combination of `sin(angle)^2` and `1`"));
  CHECK(sum.finding("terms_collinear").at("severity") == "note");  // none of the three is in the equation
}

TEST_CASE("terms that are nearly one are named") {
  // Around a displacement of 20 the powers of y say nearly the same.
  DiscoveryAnswer const near = run(file("target = u - 1 [kg]*y''\nterms = y', y, y^2, y^3, 1", "threshold(share = 1e-9), seed = 1"),
                                   Made(900, {.offset = 20}).csv());
  REQUIRE_FALSE(near.finding("terms_nearly_collinear").is_null());
  CHECK(contains(near.finding("terms_nearly_collinear").at("message"), "can hardly be distinguished"));
  CHECK(near.exit == 0);
}

TEST_CASE("terms of a large condition index that are needed and known are not called hard to distinguish") {
  // The same record: every term has probability 1 and an sd of a thousandth.
  DiscoveryAnswer const known =
      run(file("target = u - 1 [kg]*y''\nterms = y', y, y^2, y^3, 1", "seed = 1, refit = no"), Made(900, {.offset = 20}).csv());
  CHECK(known.kept().size() == 5);
  CHECK(known.finding("terms_nearly_collinear").is_null());
}

TEST_CASE("a term that is always zero is named, by its text or on the record") {
  DiscoveryAnswer const text = run(file(oscillator + ", y - y"));
  CHECK(text.exit == 0);
  CHECK(contains(text.said, "y - y  always zero"));
  CHECK(text.kept() == Texts{"y'", "y", "y^3"});
  DiscoveryAnswer const data = run(file(oscillator + ", max(y - 100 [m], 0)"));
  CHECK(data.exit == 0);
  CHECK(contains(data.finding("term_always_zero").at("message"), "`max(y - 100 [m], 0)` is zero on the whole record"));
  CHECK(data.kept() == Texts{"y'", "y", "y^3"});
}

TEST_CASE("a term that is not finite somewhere is left out by name") {
  DiscoveryAnswer const answer = run(file(oscillator + ", sqrt(y*1 [m])"));
  CHECK(answer.exit == 0);
  CHECK(contains(answer.finding("term_not_finite").at("message"), "`sqrt(y*1 [m])` is not finite in"));
  CHECK(answer.kept() == Texts{"y'", "y", "y^3"});
}

TEST_CASE("too few samples are counted") {
  for (int const rows : {2, 15, 25}) {
    CAPTURE(rows);
    DiscoveryAnswer const answer = run(file(oscillator), Made(rows).csv());
    CHECK(answer.exit == 1);
    CHECK(answer.codes() == Texts{"too_few_rows"});
    CHECK(answer.finding("too_few_rows").at("severity") == "error");
  }
  DiscoveryAnswer const samples = run(file(oscillator, "threshold(derivatives = central), seed = 1"), Made(9).csv());
  CHECK(contains(samples.finding("too_few_rows").at("message"), "samples for 5 terms are too few; at least 11 are needed"));
}

TEST_CASE("a single row is an error of the data, as for any task") {
  DiscoveryAnswer const answer = run(file(oscillator), Made(1).csv());
  CHECK(answer.exit == 65);
  CHECK(contains(answer.said, "case.sysid:7:"));
  CHECK(contains(answer.said, "error[E4"));
}

TEST_CASE("a record at rest says nothing about its equation") {
  Made still(900);
  for (double& value : still.y) value = 0.3;
  DiscoveryAnswer const answer = run(file(oscillator), still.csv());
  CHECK(answer.exit == 1);
  CHECK(answer.codes() == Texts{"record_at_rest"});
  CHECK(contains(answer.finding("record_at_rest").at("message"), "`displacement` is 0.3 on the whole record"));
}

TEST_CASE("a sensor's noise about a rest says nothing either, whatever the seed") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Made still(900);
    Stream stream({.seed = seed});
    for (double& value : still.y) value = 0.3 + 1e-4 * stream.normal();
    DiscoveryAnswer const answer = run(file(oscillator), still.csv());
    CAPTURE(seed);
    CHECK(answer.exit == 1);
    CHECK(answer.codes() == Texts{"record_at_rest"});
  }
}

TEST_CASE("a unit that no term can have is an error where it stands") {
  DiscoveryAnswer const answer = run(file(oscillator + "\ncoefficients = [N/m], [N/m^3], [N s/m], [N/m^4]"));
  CHECK(answer.exit == 65);
  CHECK(contains(answer.said, "case.sysid:6:42: error[E6609]: no term has a coefficient in [N/m^4]"));
}

TEST_CASE("missing samples cost windows, missing forces are an error") {
  DiscoveryAnswer const gap = run(file(oscillator), replaced(200, 2, "NA"));
  CHECK(gap.exit == 0);
  CHECK(gap.kept() == Texts{"y'", "y", "y^3"});
  CHECK(gap.finding("windows_missing").at("severity") == "note");
  DiscoveryAnswer const number = run(file(oscillator), replaced(200, 2, "nan"));
  CHECK(number.exit == 65);
  CHECK(contains(number.said, "case.sysid:7:"));
  DiscoveryAnswer const force = run(file(oscillator), replaced(200, 1, "NA"));
  CHECK(force.exit == 65);
  CHECK(contains(force.said, "case.sysid:7:"));
  Made made(900);
  auto const of_which = [&](auto const& measured) {
    std::string csv = "t,u,y\n";
    for (std::size_t i = 0; i < made.t.size(); ++i)
      csv += fmt::format("{:.12g},{:.12g},{}\n", made.t[i], made.u[i], measured(i) ? fmt::format("{:.12g}", made.y[i]) : "NA");
    return csv;
  };
  // No window is whole: values between neighbours serve the regression, and simulation decides.
  Stream stream({2, Purpose::test, 0, 0});
  for (DiscoveryAnswer const& filled : {run(file(oscillator), of_which([](std::size_t i) { return i % 2 == 0; })),
                                        run(file(oscillator), of_which([&](std::size_t) { return stream.uniform() > 0.08; }))}) {
    CHECK(filled.exit == 0);
    CHECK(filled.kept() == Texts{"y'", "y", "y^3"});
    CHECK(contains(filled.finding("windows_missing").at("message"), "missing samples of `bench` would leave too few windows"));
  }
  // Where none is near, nothing is made up.
  DiscoveryAnswer const none = run(file(oscillator), of_which([](std::size_t i) { return i % 20 < 8; }));
  CHECK(none.exit == 1);
  CHECK_FALSE(none.finding("too_few_rows").is_null());
  CHECK(contains(none.finding("windows_missing").at("message"), "100 % of the windows contain a missing sample"));
}

TEST_CASE("unequal steps are named, and the equation is found in spite of them") {
  DiscoveryAnswer const answer = run(file(oscillator), replaced(450, 0, "4.5031"));
  CHECK(answer.exit == 0);
  CHECK(contains(answer.finding("steps_interpolated").at("message"), "the time steps of `bench` are unequal"));
  CHECK(contains(answer.finding("steps_interpolated").at("help"), "`step`"));
}

TEST_CASE("a time column of seven digits has equal steps, and the equation is found") {
  // Steps of 1/99.7 s, which no seven digits hold.
  Made made(900);
  std::string csv = "t,u,y\n";
  for (std::size_t i = 0; i < made.t.size(); ++i)
    csv += fmt::format("{:.7g},{:.12g},{:.12g}\n", static_cast<double>(i) / 99.7, made.u[i], made.y[i]);
  DiscoveryAnswer const answer = run(file(oscillator), csv);
  CHECK(answer.exit == 0);
  CHECK(answer.kept() == Texts{"y'", "y", "y^3"});
}

TEST_CASE("the verdict says of form, coefficients and other rows in one sentence") {
  DiscoveryAnswer const answer = run(file(oscillator));
  CHECK(contains(answer.said, "the form is decided (probability "));
  CHECK(contains(answer.said, ", the coefficients have sds of "));
  CHECK(contains(answer.said, " %, the equation holds on the last fifth of bench (rms error of a free run: "));
  CHECK(contains(answer.said, "; the checks pass\n"));
  CHECK(answer.finding("residuals_not_white").is_null());
}

TEST_CASE("what a dictionary lacks shows in residuals that are correlated in time, and the checks do not pass") {
  DiscoveryAnswer const answer = run(file("target = u - 1 [kg]*y''\nterms = y', y, 1"));
  CHECK_FALSE(answer.finding("residuals_not_white").is_null());
  CHECK_FALSE(contains(answer.said, "; the checks pass\n"));
}

TEST_CASE("an input that is constant stands for the constant, and is named with it") {
  Made steady(900);
  DiscoveryAnswer const held = [&] {
    Made still(900);
    for (double& value : still.u) value = 2;
    return run(file("target = y''\nterms = y', y, y^2, y^3, u, 1"), still.csv());
  }();
  CHECK(contains(held.finding("terms_repeat").at("message"), "`1` is a multiple of `u`"));
  for (double& value : steady.u) value = 0;
  DiscoveryAnswer const zero = run(file("target = u\nterms = y'', y', y, y^3"), steady.csv());
  CHECK(zero.exit == 1);
  CHECK(zero.codes() == Texts{"column_constant", "nothing_to_explain"});
}

TEST_CASE("noise that is given takes the place of the estimate") {
  DiscoveryAnswer const estimated = run(file(oscillator));
  json const& of_record = estimated.summary.at("discovery").at("noise").at("displacement");
  CHECK(of_record.at("given") == false);
  CHECK(of_record.at("sd").get<double>() == relative(0.00175, 0.1));
  DiscoveryAnswer const given = run(file(oscillator, "noise(displacement = 0.5 [mm]), seed = 1"));
  json const& noise = given.summary.at("discovery").at("noise").at("displacement");
  CHECK(noise.at("given") == true);
  CHECK(noise.at("sd").get<double>() == relative(0.0005, 1e-14));
  // What is taken for less noise than there is leaves a residual of as many times the noise.
  double const ratio = given.summary.at("discovery").at("equations").at(0).at("noise_ratio");
  CHECK(ratio == doctest::Approx(3.5).epsilon(0.15));
  CHECK_FALSE(given.finding("unexplained_residual").is_null());
  DiscoveryAnswer const unknown = run(file(oscillator, "noise(position = 0.5 [mm]), seed = 1"));
  CHECK(unknown.exit == 65);
  CHECK(contains(unknown.said, "dictionary `terms` has no channel `position`"));
  DiscoveryAnswer const unit = run(file(oscillator, "noise(displacement = 0.5 [N]), seed = 1"));
  CHECK(unit.exit == 65);
}

TEST_CASE("a discovery that is complete is kept by --resume, one of another text is refused") {
  TemporaryFolder folder;
  write_file(folder.path() / "bench.csv", record);
  RunOptions options;
  options.output = folder.path() / "results";
  std::string const text = file(oscillator);
  CHECK(run_text(folder.path() / "case.sysid", text, options).exit == 0);
  options.resume = true;
  RunResult const again = run_text(folder.path() / "case.sysid", text, options);
  CHECK(again.exit == 0);
  CHECK(contains(again.notices, "found: complete, kept"));
  std::string const other = with(text, ", 1\n", ", 1, y*y'\n");
  CHECK_THROWS_WITH_AS(run_text(folder.path() / "case.sysid", other, options),
                       doctest::Contains("with another text of dictionary `terms`"), UserError);
}

TEST_CASE("functions of modules serve in dictionaries, and come with the model that is found") {
  TemporaryFolder folder;
  write_file(folder.path() / "bench.csv", record);
  write_file(folder.path() / "laws.sysid", "use powers\nfunction cube(z) = z*inner(z)\n");
  RunOptions options;
  options.output = folder.path() / "results";
  write_file(folder.path() / "powers.sysid", "function inner(z) = z*z\n");
  // The file's own `inner` means another thing.
  std::string const text =
      "use laws\nfunction inner(z) = 2*z\n" + file("target = u - 1 [kg]*y''\nterms = y', inner(y), y^2, cube(y), 1");
  RunResult const result = run_text(folder.path() / "case.sysid", text, options);
  CHECK(result.exit == 0);
  json const summary = json::parse(read_file(options.output / "found/summary.json"));
  DiscoveryAnswer const answer{result.exit, result.out, summary, {}};
  CHECK(answer.kept() == Texts{"y'", "inner(y)", "cube(y)"});
  std::string const source = read_file(options.output / "found/found.sysid");
  CHECK(contains(source, "powers_inner(z) = z*z"));
  CHECK(contains(source, "= z*powers_inner(z)"));
}
