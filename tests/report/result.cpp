// The result folder: complete, never overwritten unasked, the same bytes twice.
#include "report/file/task_folder.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <map>
#include <set>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "example.hpp"
#include "report/figure/figures.hpp"
#include "report/figure/gnuplot.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/standing_files.hpp"
#include "report/file/stored_report.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
namespace fs = std::filesystem;

namespace {

std::map<std::string, std::string> contents(fs::path const& folder) {
  std::map<std::string, std::string> out;
  for (fs::directory_entry const& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out[fs::relative(entry.path(), folder)] = read_file(entry.path());
  return out;
}

}  // namespace

TEST_CASE("a result folder holds draws per chain, prediction, summary, timing, report and the resolved file") {
  TemporaryFolder const folder;
  write_result(example::duffing(10), folder.path() / "posterior");
  auto const files = contents(folder.path() / "posterior");
  for (char const* name : {"draws_1.csv", "draws_4.csv", "predict.csv", "summary.json", "timing.json", "report.html",
                           "resolved.sysid", "figures/posterior.gnuplot"})
    CHECK_MESSAGE(files.contains(name), name);
  CHECK_FALSE(files.contains("draws_5.csv"));
  for (auto const& [name, bytes] : files) CHECK_MESSAGE(name.find("partial") == std::string::npos, name);
  CHECK(files.contains("figures/posterior.svg"));
}

TEST_CASE("pictures stand beside each other in the formats asked for, and go with the result they are of") {
  REQUIRE(gnuplot_installed());
  TemporaryFolder const folder;
  fs::path const path = folder.path() / "posterior";
  write_result(example::duffing(10), path, {FigureFormat::pdf, FigureFormat::text, FigureFormat::png});
  auto files = contents(path);
  for (char const* ending : {"gnuplot", "pdf", "txt", "png"})
    CHECK_MESSAGE(files.contains(std::string("figures/posterior.") + ending), ending);
  CHECK_FALSE(files.contains("figures/posterior.svg"));
  CHECK(files["report.html"].find("<svg") != std::string::npos);  // the page has its own
  write_result(example::duffing(10), path, {});
  files = contents(path);
  CHECK(files.contains("figures/posterior.gnuplot"));
  for (char const* ending : {"svg", "pdf", "txt", "png"}) CHECK_FALSE(files.contains(std::string("figures/posterior.") + ending));
  CHECK(files["report.html"].find("<svg") == std::string::npos);
}

TEST_CASE("a result without pictures starts no gnuplot, one with pictures a single one") {
  TemporaryFolder const folder;
  std::string const before = std::getenv("PATH");
  // One that tells that it was started, by a letter each time.
  fs::path const started = folder.path() / "started", program = folder.path() / "gnuplot";
  write_file(program, "#!/bin/sh\nprintf x >>'" + started.string() + "'\nPATH='" + before + "' exec gnuplot \"$@\"\n");
  fs::permissions(program, fs::perms::owner_all);
  setenv("PATH", (folder.path().string() + ":" + before).c_str(), 1);
  write_result(example::duffing(10), folder.path() / "posterior", {});
  bool const without = fs::exists(started);
  write_result(example::duffing(10), folder.path() / "posterior", {FigureFormat::svg});
  setenv("PATH", before.c_str(), 1);
  CHECK_FALSE(without);
  REQUIRE(figures(example::duffing(10)).size() > 1);
  CHECK(read_file(started) == "x");
  CHECK(fs::exists(folder.path() / "posterior/figures/posterior.svg"));
}

TEST_CASE("pictures that gnuplot refuses are named, and their scripts stay") {
  TemporaryFolder const folder;
  std::vector<DrawnFigure> const figures = {{{"fine", "", "", plot::preamble("fine", 300, 200) + "plot [0:1] x\n"}, std::nullopt},
                                            {{"broken", "", "", "this is no command\n"}, std::nullopt}};
  auto const undrawn = write_figures(figures, folder.path(), {FigureFormat::svg, FigureFormat::pdf});
  CHECK(undrawn == std::vector<std::string>{"broken.svg", "broken.pdf"});
  CHECK(undrawn_words(undrawn) == "gnuplot failed to draw broken.svg and 1 more; the scripts are in figures/");
  auto const files = contents(folder.path());
  CHECK(files.contains("figures/broken.gnuplot"));
  CHECK(files.contains("figures/fine.pdf"));
  CHECK_FALSE(files.contains("figures/broken.pdf"));
}

TEST_CASE("the same result is the same bytes but for the timing") {
  TemporaryFolder const folder;
  Report report = example::duffing(10);
  write_result(report, folder.path() / "a");
  report.timing = {{"wall_s", 7.5}};
  write_result(report, folder.path() / "b");
  auto a = contents(folder.path() / "a"), b = contents(folder.path() / "b");
  CHECK(a["timing.json"] != b["timing.json"]);
  a.erase("timing.json");
  b.erase("timing.json");
  CHECK(a == b);
}

TEST_CASE("a result is not overwritten unasked, and nothing of a removed one stays") {
  TemporaryFolder const folder;
  fs::path const path = folder.path() / "posterior";
  require_no_result(path);
  make_folder(path);
  write_file(path / "checkpoint", "kept");
  require_no_result(path);  // a checkpoint is no result
  write_result(example::duffing(10), path);
  write_file(path / "notes.txt", "mine");
  try {
    require_no_result(path);
    FAIL("overwritten");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().message.find("already contains results") != std::string::npos);
    CHECK(error.diagnostic().help.find("--force") != std::string::npos);
  }
  remove_result(path);
  auto const left = contents(path);
  CHECK(left.size() == 2);
  CHECK(left.at("notes.txt") == "mine");
  CHECK(left.at("checkpoint") == "kept");
}

TEST_CASE("a result takes the place of what an interrupted run left, files that it no longer has included") {
  TemporaryFolder const folder;
  Report report = example::duffing(10);
  write_result(report, folder.path());
  auto const whole = contents(folder.path());
  write_file(folder.path() / "draws_bouc_wen.csv", "of a model that died later");
  write_file(folder.path() / "notes.txt", "mine");
  write_result(report, folder.path());
  auto left = contents(folder.path());
  CHECK(left.erase("notes.txt") == 1);
  CHECK(left == whole);
}

TEST_CASE("predictions of several experiments have a file each") {
  TemporaryFolder const folder;
  Report report = example::duffing(10);
  report.predictions.push_back(report.predictions[0]);
  report.predictions[1].experiment = "bench.test";
  write_result(report, folder.path());
  CHECK(fs::exists(folder.path() / "predict_bench_train.csv"));
  CHECK(fs::exists(folder.path() / "predict_bench_test.csv"));
  CHECK_FALSE(fs::exists(folder.path() / "predict.csv"));
}

TEST_CASE("smoothed states of several experiments have a file each, and are read back") {
  TemporaryFolder const folder;
  Report report = example::duffing(10);
  std::string const without = record_bytes(report);
  report.states = {report.predictions[0], report.predictions[0]};
  report.states[1].experiment = "bench.test";
  for (Prediction& each : report.states) {
    each.inputs.clear();
    each.smoothed = each.quantities[0].average = true;
    for (PredictedQuantity& quantity : each.quantities) quantity.noisy = {}, quantity.measured.clear();
  }
  CHECK(record_bytes(report) != without);
  write_result(report, folder.path(), {});
  CHECK(fs::exists(folder.path() / "states_bench_train.csv"));
  CHECK(fs::exists(folder.path() / "states_bench_test.csv"));
  Report const stored = read_result(folder.path());
  REQUIRE(stored.states.size() == 2);
  CHECK(stored.states[1].smoothed);
  CHECK(stored.states[1].quantities[0].average);
  CHECK_FALSE(stored.states[1].quantities[1].average);
  CHECK(stored.states[1].quantities[0].response.upper == report.states[1].quantities[0].response.upper);
  std::string const table = read_file(folder.path() / "states_bench_test.csv");
  write_file(folder.path() / "states_bench_test.csv", table + "\n");
  CHECK_THROWS_AS(read_result(folder.path()), UserError);
}

TEST_CASE("names in Greek letters have files of their own, from which the result comes back as it was") {
  TemporaryFolder const folder;
  Report report = example::duffing(10);
  std::vector<PredictedQuantity>& quantities = report.predictions[0].quantities;
  quantities.insert(quantities.begin(), quantities[0]);
  quantities[0].name = "\u03b8";
  quantities[1].name = "\u03c6";
  report.predictions.push_back(report.predictions[0]);
  report.predictions[0].experiment = "bench.a";
  report.predictions[1].experiment = "bench_a";
  for (double const height : {1.0, 2.0}) {
    FunctionReport function{height == 1 ? "\u03c6" : "\u03c8", "N", {{"v", "m/s"}}, {}, {{}}, {}};
    for (int i = 0; i <= 10; ++i) function.cuts[0].push_back({{0.1 * i}, height, 0.1, height - 0.2, height + 0.2});
    function.grid = function.cuts[0];
    report.functions.push_back(function);
  }
  write_result(report, folder.path(), {});
  std::set<std::string> names;
  for (plot::Figure const& figure : figures(report)) {
    CHECK_MESSAGE(names.insert(figure.name).second, figure.name);
    CHECK(read_file(folder.path() / "figures" / (figure.name + ".gnuplot")) == figure.script);
    CHECK_MESSAGE(figure.script.find(" " + figure.name + ".svg draws this") != std::string::npos, figure.name);
    CHECK_MESSAGE(figure.script.find(" name '" + figure.name + "'") != std::string::npos, figure.name);
  }
  CHECK(names.contains("fit_bench_a___"));
  CHECK(names.contains("function___"));
  Report const stored = read_result(folder.path());
  REQUIRE(stored.functions.size() == 2);
  CHECK(stored.functions[0].grid[5].mean == 1);
  CHECK(stored.functions[1].grid[5].mean == 2);
  CHECK(stored.predictions[1].quantities[1].response.mean == report.predictions[1].quantities[1].response.mean);
}

TEST_CASE("a folder that cannot be written is an I/O error") {
  TemporaryFolder const folder;
  write_file(folder.path() / "file", "");
  CHECK_THROWS_AS(write_result(example::duffing(2), folder.path() / "file"), IoError);
}
