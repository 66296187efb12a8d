// `report`: pages of folders, and what is said of folders that hold none, or hold them no longer.
#include "app/run/report_results.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "app/answer.hpp"
#include "app/running.hpp"
#include "app/session/left_by_kill.hpp"
#include "app/session/reporting.hpp"
#include "app/stored_pages.hpp"
#include "report/figure/gnuplot.hpp"
#include "report/file/report_cbor.hpp"
#include "report/file/sealed_cbor.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/stored_report.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

namespace fs = std::filesystem;

std::string const text =
    "model decay \"Decay & <growth>\" {\n  state y\n  initial y = 1\n  parameter k ~ log_uniform(0.1, 10)\n"
    "  parameter a ~ normal(1, sd = 2)\n  y' = -k*a*y\n  observe size ~ normal(y, sd = 0.1)\n}\n"
    "data dish {\n  file \"growth.csv\"\n  time t [s]\n  measure size = y\n}\n"
    "posterior = fit decay to dish with mh(samples = 60, burn_in = 20, thin = 1, chains = 2), seed = 1\n"
    "forecast = predict posterior on dish with draws(10), seed = 1\n";

/// Too few draws to be used: the checks fail.
struct DishRun {
  TemporaryFolder folder;
  fs::path results = folder.path() / "results";

  explicit DishRun(bool pictures = false, std::string const& source = text) {
    write_file(folder.path() / "growth.csv", content(error_examples / "data/growth.csv"));
    RunOptions options;
    options.output = results;
    options.figures = pictures;
    Source file((folder.path() / "dish.sysid").string(), source);
    Diagnostics diagnostics;
    auto const checked = load(file, diagnostics);
    REQUIRE(checked);
    SilentProgress silent;
    std::ostringstream out, notices;
    for (char const* verb : {"fit", "predict"}) run_tasks(file, *checked, {verb}, options, silent, out, notices);
  }
};

/// The message and the help of what is refused, the folder left out; "" when nothing is.
std::string refusal(fs::path const& results, fs::path const& folder) {
  try {
    report_results(results, std::nullopt, false);
  } catch (UserError const& error) {
    return without(error.diagnostic().message + "\n" + error.diagnostic().help, folder.string() + "/");
  } catch (IoError const& error) {
    return without(std::string("74: ") + error.what(), folder.string() + "/");
  }
  return "";
}

}  // namespace

TEST_CASE("a page made from a folder is the one that the run wrote, pictures included") {
  REQUIRE(gnuplot_installed());
  DishRun const run(true);
  for (char const* task : {"posterior", "forecast"}) {
    std::string const written = read_file(run.results / task / "report.html");
    CHECK(written.find("<figure") != std::string::npos);
    write_file(run.results / task / "report.html", "");
    CHECK(report_results(run.results / task, std::nullopt, true) == run.results / task / "report.html");
    CHECK(read_file(run.results / task / "report.html") == written);
  }
}

TEST_CASE("a run that fails its checks keeps the promises of pages, too") {
  DishRun const run;
  CHECK(read_file(run.results / "posterior" / "report.html").find("class=\"part verdict bad\"") != std::string::npos);
  CHECK(broken_promises(run.results) == "");
}

TEST_CASE("the page of a whole run holds its tasks in the order of the file") {
  DishRun const run;
  report_results(run.results, run.folder.path() / "all.html", false);
  std::string const page = read_file(run.folder.path() / "all.html");
  std::size_t const first = page.find("<section id=\"task-1\""), second = page.find("<section id=\"task-2\"");
  REQUIRE(second != std::string::npos);
  std::size_t const posterior = page.find(">posterior: Decay &amp; &lt;growth&gt;</h2>");
  CHECK(posterior > first);
  CHECK(posterior < second);
  CHECK(page.find(">forecast: Decay &amp; &lt;growth&gt;</h2>") > second);
  CHECK(page.find("<a href=\"#task-2\">forecast</a>") < first);
}

TEST_CASE("the page of a whole run says its number of tasks once, and of each the verdict of its own page") {
  DishRun const run;
  report_results(run.results, run.folder.path() / "all.html", false);
  std::string const page = read_file(run.folder.path() / "all.html");
  CHECK(page.find("<p class=\"task\">A run of 2 tasks</p>\n<h1>Decay &amp; &lt;growth&gt;</h1>") != std::string::npos);
  for (char const* task : {"posterior", "forecast"}) {
    std::string const own = read_file(run.results / task / "report.html");
    std::size_t const begin = own.find("<p class=\"headline\">") + 20;
    std::string headline = own.substr(begin, own.find("</p>", begin) - begin);
    headline[0] = static_cast<char>(headline[0] - 'A' + 'a');
    CHECK_MESSAGE(page.find("<b>" + headline + "</b></li>") != std::string::npos, headline);
  }
}

TEST_CASE("fits of the same samples stand side by side on the page of a run, of other samples they are not compared") {
  std::string const other = with(with(text, "model decay \"Decay & <growth>\"", "model still"), "y' = -k*a*y", "y' = 0*k*a*y");
  std::string const model = other.substr(0, other.find("data dish"));
  std::string const fits = with(text, "data dish {", model + "data dish {").substr(0, (model + text).find("posterior = ")) +
                           "grows = fit decay to dish with map, seed = 1\nstays = fit still to dish with map, seed = 1\n";
  DishRun const run(false, fits);
  report_results(run.results, run.folder.path() / "all.html", false);
  std::string const page = read_file(run.folder.path() / "all.html");
  CHECK(page.find("<h1>A run of 2 tasks</h1>") != std::string::npos);
  CHECK(page.find("log Bayes factor") != std::string::npos);
  CHECK(page.find("<td class=\"n\">0.0</td>") != std::string::npos);  // the best against itself
  CHECK(page.find("<a href=\"#together\">") != std::string::npos);
  CHECK(page.find("compared only within one set") == std::string::npos);

  std::string const parts =
      with(with(fits, "measure size = y\n", "measure size = y\n  split early = rows 1..2, late = rows 3..4\n"),
           "grows = fit decay to dish ", "grows = fit decay to dish.early ");
  DishRun const apart(false, with(parts, "stays = fit still to dish ", "stays = fit still to dish.late "));
  report_results(apart.results, apart.folder.path() / "all.html", false);
  std::string const second = read_file(apart.folder.path() / "all.html");
  CHECK(second.find("log Bayes factor</th>") == std::string::npos);
  CHECK(second.find("2 different sets of samples; evidences can be compared only within one set") != std::string::npos);
}

TEST_CASE("predictions are found on the page of a run by their verb, not by the words of a summary") {
  std::string const second = "again = predict posterior on dish with draws(12), seed = 2\n";
  DishRun const run(false, text + second);
  report_results(run.results, run.folder.path() / "all.html", false);
  std::string const page = read_file(run.folder.path() / "all.html");
  std::string const together = "<a href=\"#together\">";
  CHECK(page.find(together) != std::string::npos);
  for (char const* task : {"forecast", "again"}) {
    auto summary = nlohmann::ordered_json::parse(read_file(run.results / task / "summary.json"));
    CHECK(summary.at("verb") == "predict");
    summary["what"] = "other words";
    write_file(run.results / task / "summary.json", sealed_summary(summary.dump(2)));
  }
  report_results(run.results, run.folder.path() / "all.html", false);
  CHECK(read_file(run.folder.path() / "all.html") == page);
  for (char const* task : {"forecast", "again"}) {
    fs::path const path = run.results / task / "report.cbor";
    Report record = read_record(read_file(path), path);
    record.what = "other words";
    write_file(path, record_bytes(record));
  }
  report_results(run.results, run.folder.path() / "all.html", false);
  CHECK(read_file(run.folder.path() / "all.html").find(together) != std::string::npos);
}

TEST_CASE("tasks that were interrupted before they had a result have a line on the page of their run") {
  DishRun const run;
  fs::create_directory(run.results / "late");
  write_file(run.results / "late" / "checkpoint.cbor", ".");
  report_results(run.results, run.folder.path() / "all.html", false);
  std::string const page = read_file(run.folder.path() / "all.html");
  CHECK(page.find("A run of 3 tasks") != std::string::npos);
  CHECK(page.find("late <b>interrupted before it had a result; continue with --resume</b>") != std::string::npos);
}

TEST_CASE("what another version wrote is told from what is damaged") {
  DishRun const run;
  fs::path const record = run.results / "posterior" / "report.cbor";
  std::string const bytes = read_file(record);
  std::string const other =
      "`results/posterior/report.cbor` was written by another version of sysid\nrun the task again with --force";
  auto const refused_as = [&](std::string const& changed) {
    write_file(record, changed);
    return refusal(run.results / "posterior", run.folder.path());
  };
  nlohmann::json const whole = nlohmann::json::from_cbor(bytes);
  int const form = whole.at("form").get<int>();
  nlohmann::json report = nlohmann::json::from_cbor(whole.at("content").get_binary());
  CHECK(refused_as(sealed_cbor(report, form)) == "");
  CHECK(refused_as(sealed_cbor(report, form - 1)) == other);
  // Members that are missing in bytes that are whole were never written.
  report.erase("functions");
  CHECK(refused_as(sealed_cbor(report, form)) == other);
  nlohmann::json changed = whole;
  changed["form"] = form - 1;
  auto const unsealed = nlohmann::json::to_cbor(changed);
  CHECK(refused_as({unsealed.begin(), unsealed.end()}) ==
        "`results/posterior/report.cbor` is damaged\nrun the task again with --force");
}

TEST_CASE("the command makes the same result again, whatever the folder is called") {
  std::string const shell_word = "it's; a \"$HOME\" `name`";
  TemporaryFolder const folder;
  Source const source((folder.path() / shell_word / "dish.sysid").string(), text);
  DishRun const run;  // any checked file
  Source file(source.name(), text);
  Diagnostics diagnostics;
  auto const checked = load(file, diagnostics);
  REQUIRE(checked);
  RunOptions options;
  options.output = fs::path(shell_word) / "-results/";
  options.seed = 7;
  SilentProgress silent;
  std::ostringstream nowhere;
  Session session(file, *checked, options, silent, nowhere, nowhere);
  Report report;
  add_repetition(session, checked->tasks[0], report);
  // The shell itself takes the words apart.
  std::string const words_file = (folder.path() / "words").string();
  std::string const command = "f() { printf '%s\\n' \"$@\"; }; f" + report.command.substr(5) + " > " + words_file;
  REQUIRE(report.command.starts_with("sysid"));
  REQUIRE(std::system(command.c_str()) == 0);
  CHECK(read_file(words_file) ==
        "run\n" + source.name() + "\n--seed\n0\n-o\n" + (fs::path(shell_word) / "-results_again").string() + "\n");
}

TEST_CASE("seeds that were drawn stand in the command, or are named where others are stated") {
  TemporaryFolder const folder;
  auto const repetition = [&](std::string const& source) {
    Source file("dish.sysid", source);
    Diagnostics diagnostics;
    auto const checked = load(file, diagnostics);
    REQUIRE(checked);
    SilentProgress silent;
    std::ostringstream nowhere;
    RunOptions const options;
    Session session(file, *checked, options, silent, nowhere, nowhere);
    Report report;
    report.seed = 5;
    add_repetition(session, checked->tasks[1], report);  // the prediction
    return report;
  };
  CHECK(repetition(text).command == "sysid run dish.sysid -o results_again");
  std::string const unseeded = with(text, ", seed = 1", "");
  CHECK(repetition(unseeded).command == "sysid run dish.sysid --seed 5 -o results_again");
  CHECK(repetition(unseeded).unseeded.empty());
  std::string const mixed = with(text, "chains = 2), seed = 1", "chains = 2)");
  CHECK(repetition(mixed).command == "sysid run dish.sysid -o results_again");
  CHECK(repetition(mixed).unseeded == std::vector<std::string>{"posterior"});
}

TEST_CASE("a page that cannot be written is an error of input and output, whatever is made of it") {
  DishRun const run;
  for (fs::path const& results : {run.results, run.results / "posterior"})
    CHECK_THROWS_AS(report_results(results, run.folder.path() / "nowhere" / "page.html", false), IoError);
}

TEST_CASE("after a kill `report` sees what the next run sees") {
  DishRun const run;
  fs::path const fit = run.results / "posterior", forecast = run.results / "forecast";
  std::string const page = read_file(fit / "report.html");
  leave_half_renamed(fit);
  CHECK(refusal(fit, run.folder.path()) == "");
  CHECK(read_file(fit / "report.html") == page);
  leave_half_renamed(fit);
  CHECK(refusal(run.results, run.folder.path()) == "");
  leave_half_renamed(fit);
  CHECK(read_result(fit).task == "posterior");
  leave_half_written(fit);
  CHECK(refusal(run.results, run.folder.path()) == "");  // the prediction is there
  CHECK(refusal(fit, run.folder.path()).starts_with("`results/posterior` contains no results\n"));
  fs::remove(forecast / "summary.json");
  fs::remove(forecast / "report.cbor");
  CHECK(refusal(forecast, run.folder.path())
            .starts_with("`results/forecast` contains no complete result: it has no `summary.json`\n"));
}

TEST_CASE("what is missing or damaged is named, and the page of before stays") {
  DishRun const run;
  fs::path const task = run.results / "posterior";
  std::string const page = read_file(task / "report.html");
  auto const refused = [&](fs::path const& results) { return refusal(results, run.folder.path()); };

  CHECK(refused(run.folder.path() / "nothing") == "74: there is no folder `nothing`");
  fs::create_directory(run.folder.path() / "empty");
  CHECK(refused(run.folder.path() / "empty") ==
        "`empty` contains no results\ngive the folder of a task, such as results/posterior, or of a whole run, such as results");

  std::string const record = read_file(task / "report.cbor");
  for (std::size_t const at : {std::size_t{0}, record.size() / 3, record.size() - 1}) {
    std::string changed = record;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    write_file(task / "report.cbor", changed);
    CHECK(refused(task) == "`results/posterior/report.cbor` is damaged\nrun the task again with --force");
  }
  write_file(task / "report.cbor", record.substr(0, record.size() / 2));
  CHECK(refused(task) == "`results/posterior/report.cbor` is damaged\nrun the task again with --force");
  remove_file(task / "report.cbor");
  CHECK(refused(task).starts_with("the results in `results/posterior` have no `report.cbor`\n"));
  write_file(task / "report.cbor", record);

  std::string const draws = read_file(task / "draws_2.csv");
  write_file(task / "draws_2.csv", draws.substr(0, draws.size() - 3));
  std::string const changed =
      "`results/posterior/draws_2.csv` has been changed since it was written\nrun the task again with --force";
  CHECK(refused(task) == changed);
  write_file(task / "draws_2.csv", draws.substr(0, draws.rfind('\n', draws.size() - 2) + 1));
  CHECK(refused(task) == changed);
  write_file(task / "draws_2.csv", with(draws, ",k,a\n", ",k,b\n"));
  CHECK(refused(task) == changed);
  remove_file(task / "draws_2.csv");
  CHECK(refused(task).starts_with("`results/posterior/draws_2.csv`, a file of this result, is missing\n"));
  CHECK(refused(run.results).starts_with("`results/posterior/draws_2.csv`, a file of this result, is missing\n"));
  write_file(task / "draws_2.csv", draws);

  std::string const summary = read_file(task / "summary.json");
  remove_file(task / "summary.json");
  CHECK(refused(task).starts_with("`results/posterior` contains no complete result: it has no `summary.json`\n"));
  write_file(task / "summary.json", summary);
  CHECK(read_file(task / "report.html") == page);
  CHECK(refused(task) == "");
  CHECK(read_file(task / "report.html") == page);
}
