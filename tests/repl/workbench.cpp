// Sessions without a terminal.
#include "repl/workbench.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "app/run/pipeline.hpp"
#include "core/system/digest.hpp"
#include "core/system/interrupt.hpp"
#include "dialogue.hpp"
#include "repl/prompt.hpp"
#include "report/file/stored_files.hpp"

using namespace sysid;

namespace {

bool has(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

/// The number that an expression is.
double number(Dialogue& dialogue, std::string const& expression) {
  CHECK_MESSAGE(dialogue.enter(expression), dialogue.messages());
  return std::stod(dialogue.answers());
}

std::string summary_of(std::filesystem::path const& folder) { return read_file(folder / "summary.json"); }

}  // namespace

TEST_CASE("a model, its data, a fit, a term more, a refit: entered one by one, and each is checked when it is entered") {
  Dialogue d;
  d.begin();
  CHECK_MESSAGE(d.enter("first = fit oscillator to bench.train with map"), d.messages());
  CHECK(has(d.answers(), "first: fit oscillator to bench.train with map"));
  double const linear = number(d, "rms(residual(displacement))"), sd = number(d, "sd(k)");
  CHECK(sd > 0);
  // Both at once, since neither stands alone.
  CHECK_MESSAGE(d.enter("parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11); 1 [kg]*y'' + c*y' + k*y + k3*y^3 = x"), d.messages());
  CHECK(has(d.messages(), "the earlier `oscillator` is kept as `oscillator_1`"));
  CHECK_MESSAGE(d.enter("refit"), d.messages());
  CHECK(has(d.messages(), "first2 = fit oscillator to bench.train with map, seed = 1, search = near(first)"));
  CHECK(number(d, "rms(residual(displacement))") < 0.5 * linear);
  CHECK(std::abs(number(d, "mean(k3)") - 5e9) < 4 * number(d, "sd(k3)"));
  CHECK(number(d, "first.k") != number(d, "k"));
  CHECK(number(d, "rms(residual(first.displacement))") == linear);
}

TEST_CASE("fits of a session are compared by their evidence, and what has not been run is named") {
  Dialogue d;
  d.begin();
  CHECK_FALSE(d.enter("compare"));
  CHECK(has(d.messages(), "no fit and no prediction has been run yet"));
  REQUIRE(d.enter("first = fit oscillator to bench.train with map"));
  REQUIRE(d.enter("parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11); 1 [kg]*y'' + c*y' + k*y + k3*y^3 = x"));
  REQUIRE(d.enter("refit"));
  REQUIRE_MESSAGE(d.enter("compare"), d.messages());
  CHECK(has(d.answers(), "fitted to bench.train, rows 1..200 (200 scored)"));
  // The model has changed in between: `list` has two names for it.
  CHECK(has(d.answers(), "first   oscillator_1 "));
  CHECK(has(d.answers(), "first2  oscillator "));
  CHECK_FALSE(has(d.answers(), "different models"));
  REQUIRE(d.enter("forecast = predict first on bench.train with draws(1)"));
  REQUIRE(d.enter("compare"));
  CHECK(has(d.answers(), "forecast    oscillator_1 "));
  CHECK_FALSE(d.enter("compare first, second"));
  CHECK_FALSE(d.enter("compare firs"));
  CHECK(has(d.messages(), "there is no result of `firs`"));
  CHECK(has(d.messages(), "did you mean `first`"));
}

TEST_CASE("a refit with new options keeps the others, the back end among them") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("first = fit oscillator to bench.train with map, substeps = 2, seed = 3"));
  REQUIRE_MESSAGE(d.enter("refit with seed=5"), d.messages());
  CHECK(has(d.messages(), "first2 = fit oscillator to bench.train with map, substeps = 2, seed=5, search = near(first)"));
  REQUIRE_MESSAGE(d.enter("refit first as third with ml"), d.messages());
  CHECK(has(d.messages(), "third = fit oscillator to bench.train with ml, substeps = 2, seed = 3, search = near(first)"));
}

TEST_CASE("a refit may begin everywhere, and cannot take the place of what it begins from") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("drag = fit oscillator to bench.train with map"));
  CHECK_FALSE(d.enter("refit as drag"));
  CHECK(has(d.messages(),
            "`drag` is the fit that the refit starts from and cannot be replaced by it\nhelp: use another name, "
            "`refit as drag2`"));
  REQUIRE_MESSAGE(d.enter("refit with search = everywhere"), d.messages());
  CHECK(has(d.messages(), "drag2 = fit oscillator to bench.train with map, seed = 1, search = everywhere\n"));
  REQUIRE_MESSAGE(d.enter("refit drag as drag with search = everywhere"), d.messages());
}

TEST_CASE("a task that begins from another one says which, where that has not been run") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("save " + d.path("sub.sysid")));
  write_file(d.path("sub.sysid"), read_file(d.path("sub.sysid")) +
                                      "\nfirst = fit oscillator to bench.train with map, seed = 1\n"
                                      "second = fit oscillator to bench.train with map, search = near(first), seed = 1\n"
                                      "forecast = predict second on bench\n");
  Dialogue other;
  REQUIRE_MESSAGE(other.enter("load " + d.path("sub.sysid")), other.messages());
  CHECK_FALSE(other.enter("run second"));
  CHECK(other.messages() == "`second` starts from the draws of `first`, but there are none yet\nhelp: `run first`\n");
  CHECK_FALSE(other.enter("run forecast"));
  CHECK(has(other.messages(), "help: `run second`"));
  CHECK_MESSAGE(other.enter("run first second forecast"), other.messages());
  REQUIRE_MESSAGE(other.enter("both = predict first, second on bench with draws(1)"), other.messages());
  CHECK(has(other.answers(), "Average and its members"));
}

TEST_CASE("a saved session is a file that gives the same numbers, to the last digit") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("first = fit oscillator to bench.train with mh(samples = 400, burn_in = 200, thin = 2, chains = 2)"));
  REQUIRE(d.enter("parameter c [N s/m] ~ log_uniform(5, 100)"));
  REQUIRE(d.enter("refit as second with map"));
  REQUIRE_MESSAGE(d.enter("save " + d.path("saved.sysid")), d.messages());
  Source source(d.path("saved.sysid"), read_file(d.path("saved.sysid")));
  CHECK(has(source.all_text(), "first  = fit oscillator_1 to bench.train"));
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE(file);
  RunOptions options;
  options.output = d.folder() / "again";
  options.figures = false;
  SilentProgress silent;
  std::ostringstream out, notices;
  run_tasks(source, *file, {}, options, silent, out, notices);
  for (char const* task : {"first", "second"}) {
    auto there = nlohmann::json::parse(summary_of(d.folder() / "results" / task)),
         again = nlohmann::json::parse(summary_of(options.output / task));
    CHECK(there.at("parameters") == again.at("parameters"));
    CHECK(there.at("fit") == again.at("fit"));
  }
  CHECK(read_file(options.output / "made" / "made.csv") == read_file(d.folder() / "results" / "made" / "made.csv"));
}

TEST_CASE("a mistake shows where it stands in what was typed, and leaves the work as it was") {
  Dialogue d;
  d.begin();
  std::string const before = d.workbench().work().text();
  CHECK_FALSE(d.enter("parameter k [N] ~ log_uniform(1e3, 1e5)"));
  CHECK(has(d.messages(), "error[E2103]"));
  CHECK(has(d.messages(), "work.sysid:"));  // the equation, which was not typed now
  CHECK_FALSE(d.enter("  1 [kg]*y'' + c*y' + kk*y = x"));
  CHECK_MESSAGE(has(d.messages(), "prompt:1:23: error[E2001]"), d.messages());
  CHECK(has(d.messages(), "did you mean `k`"));
  CHECK(has(d.messages(), "more: help E2001"));
  CHECK_FALSE(d.enter("first = fit oscillator to bench.trai with map"));
  CHECK_FALSE(d.enter("first = fitt oscillator to bench with map"));
  CHECK(has(d.messages(), "did you mean `fit`"));
  CHECK_FALSE(d.enter("mean(kk)"));
  CHECK_FALSE(d.enter("mean(k"));
  CHECK_FALSE(d.enter("load nowhere.sysid"));
  CHECK_FALSE(d.enter("frobnicate"));
  CHECK(d.workbench().work().text() == before);
}

TEST_CASE("a value that is given to a name takes the place of no equation") {
  Dialogue d;
  d.begin();
  std::string const before = d.workbench().work().text();
  for (auto const& [entry, help] : {std::pair("k = 5000", "write `parameter k [N/m] = 5000`"),
                                    {"fn = 3", "write `derive fn [Hz] = 3`"},
                                    {"x = 5", "a column of the data block"},
                                    {"q = 5", "`let q = 5`"}}) {
    CAPTURE(entry);
    CHECK_FALSE(d.enter(entry));
    CHECK_MESSAGE(has(d.messages(), help), d.messages());
  }
  CHECK(d.workbench().work().text() == before);
  CHECK_MESSAGE(d.enter("parameter k [N/m] = 5000"), d.messages());
  // Terms of an equation may stand on either side.
  CHECK_MESSAGE(d.enter("x = 1 [kg]*y'' + k*y"), d.messages());
}

TEST_CASE("commands of other prompts are answered with those of this one") {
  Dialogue d;
  d.begin();
  for (auto const& [entry, help] : {std::pair("delete bench", "write `drop bench`"),
                                    {"clear all", "`drop NAME` removes"},
                                    {"plot oscillator", "write `plot(oscillator)`"},
                                    {"print k", "write `k`"},
                                    {"who", "write `list`"},
                                    {"undo", "`reload` goes back"},
                                    {"head bench", "write `show bench`"},
                                    {"open m.sysid", "write `load m.sysid`"},
                                    {"rename k stiffness", "enter the statement under its new name"},
                                    {"reset", "begins with a file"},
                                    {"edit", "takes the place of the one with its name"},
                                    {"help()", "write `help`"},
                                    {"exit()", "write `quit`"},
                                    {":q", "write `quit`"},
                                    {":wq", "write `quit`"},
                                    {"explain E2103", "write `help E2103`"},
                                    {"man noise", "write `help noise`"},
                                    {"residual", "write `residual(CHANNEL)`"},
                                    {"first[\"k\"]", "write `first.k`"}}) {
    CAPTURE(entry);
    CHECK_FALSE(d.enter(entry));
    CHECK_MESSAGE(has(d.messages(), help), d.messages());
  }
}

TEST_CASE("a column that is not in the file is told when it is entered, at its place") {
  Dialogue d;
  d.begin();
  std::string const before = d.workbench().work().text();
  CHECK_FALSE(d.enter("measure displacement = displacment [m]"));
  CHECK_MESSAGE(has(d.messages(), "prompt:1:24: error[E4008]"), d.messages());
  CHECK(has(d.messages(), "did you mean `displacement`?"));
  CHECK_FALSE(d.enter("data other { file \"" + d.path("results/made/made.csv") + "\"; time t [s]; input x = z [N] hold linear }"));
  CHECK(has(d.messages(), "has no column `z`"));
  CHECK(d.workbench().work().text() == before);
  // Nobody knows what will stand in a file that is not there yet.
  CHECK_MESSAGE(d.enter("data later { file \"later.csv\"; time t [s]; input x = z [N] hold linear }"), d.messages());
  CHECK_MESSAGE(d.enter("change bench"), d.messages());
  CHECK_MESSAGE(d.enter("measure displacement = displacement [m]"), d.messages());
}

TEST_CASE("a task that cannot run is no part of the work") {
  Dialogue d;
  d.begin();
  make_folder(d.folder() / "results" / "old");
  write_file(d.folder() / "results" / "old" / "summary.json", "{}");
  CHECK_FALSE(d.enter("old = fit oscillator to bench.train with map"));
  CHECK_MESSAGE(has(d.messages(), "give the task another name"), d.messages());
  CHECK(d.workbench().work().find("old") == d.workbench().work().items.size());
  // Its own results a session may replace.
  CHECK(d.enter("new = fit oscillator to bench.train with map"));
  CHECK_MESSAGE(d.enter("new = fit oscillator to bench.train with ml"), d.messages());
}

TEST_CASE("expressions over draws are computed draw by draw, with units") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("post = fit oscillator to bench.train with mh(samples = 600, burn_in = 200, thin = 2, chains = 2)"));
  CHECK(number(d, "count(k)") == 400);
  double const k = number(d, "mean(k)");
  CHECK(number(d, "mean(k/1000 [N/m])") == doctest::Approx(k / 1000).epsilon(1e-5));
  CHECK(number(d, "quantile(k, 0.95)") > number(d, "median(k)"));
  CHECK(number(d, "corr(k, k)") == doctest::Approx(1));
  CHECK(number(d, "corr(k, -k)") == doctest::Approx(-1));
  CHECK(number(d, "probability(k > " + std::to_string(k) + ")") == doctest::Approx(0.5).epsilon(0.2));
  CHECK(number(d, "mean(sqrt(k/1 [kg])/(2*pi))") == doctest::Approx(number(d, "mean(fn)")).epsilon(1e-4));
  REQUIRE(d.enter("k"));
  CHECK(has(d.answers(), "draws of post"));
  REQUIRE(d.enter("post"));
  CHECK(has(d.answers(), "post: fit oscillator"));
  CHECK_FALSE(d.enter("k + c"));  // N/m and N s/m
  CHECK(has(d.messages(), "E2103"));
  CHECK_FALSE(d.enter("corr(k, displacement)"));
  CHECK_FALSE(d.enter("quantile(k, 95)"));
}

TEST_CASE("draws of different fits, and samples of different records, are not paired") {
  Dialogue d;
  d.begin();
  std::string const with = " with mh(samples = 400, burn_in = 200, thin = 2, chains = 2)";
  REQUIRE(d.enter("a = fit oscillator to bench.train" + with));
  REQUIRE(d.enter("b = fit oscillator to bench.train" + with + ", seed = 2"));
  for (char const* entry : {"corr(a.k, b.k)", "plot(a.k, b.k)", "mean(a.k - b.k)"}) {
    CAPTURE(entry);
    CHECK_FALSE(d.enter(entry));
    CHECK_MESSAGE(has(d.messages(), "draws of a and draws of b cannot be combined element by element"), d.messages());
  }
  CHECK(d.enter("corr(a.k, a.c)"));
  CHECK_FALSE(d.enter("corr(a.k, mean(a.c))"));
  CHECK(has(d.messages(), "this is one number"));
  CHECK(d.enter("mean(a.k) - mean(b.k)"));
  // Two predictions of one record go together; those of as many rows of another one do not.
  CHECK(d.enter("rms(predicted(a.displacement) - predicted(b.displacement))"));
  CHECK(d.enter("corr(residual(a.displacement), residual(b.displacement))"));
  REQUIRE(d.enter("split train = rows 1..150, later = rows 151..300"));
  REQUIRE(d.enter("forecast = predict a on bench.train with draws(20)"));
  REQUIRE(d.enter("other = predict a on bench.later with draws(20)"));
  for (char const* entry : {"corr(residual(forecast.displacement), residual(other.displacement))",
                            "plot(predicted(forecast.displacement), predicted(other.displacement))"}) {
    CAPTURE(entry);
    CHECK_FALSE(d.enter(entry));
    CHECK_MESSAGE(has(d.messages(), "rows of a record"), d.messages());
  }
}

TEST_CASE("an optimum says that it has no draws, whatever is asked of it") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("best = fit oscillator to bench.train with map"));
  for (char const* entry :
       {"probability(k > 1 [N/m])", "quantile(k, 0.5)", "corr(k, c)", "sd(2*k)", "plot(k, c)", "plot(k)", "plot(k/c)"}) {
    CAPTURE(entry);
    CHECK_FALSE(d.enter(entry));
    CHECK_MESSAGE(has(d.messages(), "`best` is an optimum, a single point without draws"), d.messages());
  }
  CHECK(d.enter("sd(k)"));
  CHECK_FALSE(d.enter("plot(mean(k), k)"));
  CHECK(has(d.messages(), "this is one number"));
}

TEST_CASE("plots are drawn in the size asked for, of what they are said to be of") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("post = fit oscillator to bench.train with mh(samples = 400, burn_in = 200, thin = 2, chains = 2)"));
  d.workbench().set_plot_size({30, 6});
  for (char const* what : {"trace(k)", "histogram(k)", "k", "k, c", "residual(displacement)", "post", "y'",
                           "predicted(displacement), residual(displacement)"}) {
    REQUIRE_MESSAGE(d.enter(std::string("plot(") + what + ")"), what);
    CHECK_MESSAGE(has(d.answers(), "\u2514"), what);
  }
  CHECK(has(d.answers(), "residual(displacement) [m]"));
  CHECK_FALSE(d.enter("plot(mean(k))"));
  CHECK_FALSE(d.enter("plot(trace(kk))"));
  CHECK_FALSE(d.enter("trace(k)"));
  CHECK(has(d.messages(), "plot(trace(k))"));
}

TEST_CASE("the columns of a data block are drawn against time before any fit, in the units of the file") {
  Dialogue d;
  std::string text = "time;ms;pos\n";
  for (int i = 0; i < 40; ++i)
    text += std::to_string(i * 10) + ";" + (i < 20 ? "5" : "7,5") + ";" + (i == 3 ? "" : std::to_string(i)) + "\n";
  write_file(d.path("raw.csv"), text);
  REQUIRE(d.enter("data bench { file \"" + d.path("raw.csv") +
                  "\"; read decimal = \",\"; time time [ms]; input x = ms [N] hold linear; measure displacement = pos [mm]; "
                  "split late = rows 21..40 }"));
  d.workbench().set_plot_size({30, 6});
  REQUIRE_MESSAGE(d.enter("plot(bench)"), d.messages());
  CHECK(has(d.answers(), "displacement [mm]"));
  CHECK(has(d.answers(), "time [ms]"));
  CHECK(has(d.answers(), "39"));
  CHECK(has(d.answers(), "390"));
  CHECK_FALSE(has(d.answers(), "x [N]"));
  REQUIRE_MESSAGE(d.enter("plot(bench.x)"), d.messages());
  CHECK(has(d.answers(), "x [N]"));
  CHECK(has(d.answers(), "7.5"));
  REQUIRE_MESSAGE(d.enter("plot(bench.late)"), d.messages());
  CHECK(has(d.answers(), "200"));
  CHECK_FALSE(d.enter("plot(bench.lat)"));
  CHECK(has(d.messages(), "data `bench` has no channel, input or range `lat`"));
  CHECK(has(d.messages(), "did you mean `late`?"));
  CHECK_FALSE(d.enter("plot(displacement)"));
  CHECK(has(d.messages(), "`plot(bench.displacement)`"));
  CHECK_FALSE(d.enter("mean(bench)"));
  CHECK(has(d.messages(), "`bench` is a data block, not a result"));
  CHECK(has(d.messages(), "`plot(bench)` draws its channels"));
  CHECK_FALSE(d.enter("plot(bensh)"));
  CHECK_FALSE(has(d.messages(), "channel, input or range"));
  // A column that is not there is named as elsewhere, and a file that is not there ends nothing.
  REQUIRE(d.enter("data away { file \"nowhere.csv\"; rate 10 [Hz]; measure y = y [m] }"));
  CHECK_FALSE(d.enter("plot(away)"));
  CHECK(has(d.messages(), "nowhere.csv"));
}

TEST_CASE("half an equation, and a parameter that is set, are answered with what is written here") {
  Dialogue d;
  REQUIRE(d.enter(oscillator));
  CHECK_FALSE(d.enter("= 3"));
  CHECK(has(d.messages(), "but found `=`"));
  CHECK(has(d.messages(), "an equation has two sides: `left = right`"));
  CHECK_FALSE(d.enter("k ="));
  CHECK(has(d.messages(), "expected a value but found the end of the line"));
  CHECK_FALSE(d.enter("set c = 3"));
  CHECK(has(d.messages(), "`parameter c = 3`"));
}

TEST_CASE("a fit that is stopped keeps its draws, and goes on to the bytes of an unbroken one") {
  std::string const task = "post = fit oscillator to bench.train with mh(samples = 4000, burn_in = 1000, thin = 5, chains = 2)";
  auto const draws = [](Dialogue& d) {
    std::vector<std::vector<double>> columns;
    for (repl::Result const& result : d.workbench().results())
      for (repl::DrawColumn const& column : result.draws) columns.push_back(column.values);
    return columns;
  };
  Dialogue whole;
  whole.begin();
  REQUIRE(whole.enter(task));
  // At a safe point in the middle of sampling, as Ctrl-C would be; where that is depends on how often a run asks.
  std::optional<Dialogue> broken;
  double kept = 0;
  for (std::uint64_t polls = 50; kept == 0 && polls < 10000; polls += polls / 2) {
    broken.emplace();
    broken->begin();
    broken->workbench().interrupt_after(polls);
    REQUIRE_MESSAGE(broken->enter(task), broken->messages());
    if (broken->enter("count(k)")) kept = std::stod(broken->answers());
  }
  CHECK(kept < 1200);
  REQUIRE(broken->enter("list"));
  CHECK(has(broken->answers(), "stopped"));
  CHECK_MESSAGE(broken->enter("forecast = predict post on bench with draws(20)"), broken->messages());
  REQUIRE_MESSAGE(broken->enter("resume"), broken->messages());
  CHECK((draws(whole) == draws(*broken)));
  CHECK(draws(whole).size() == 4);
  CHECK_FALSE(broken->enter("resume"));
}

TEST_CASE("a fit that is stopped before its first draw leaves none of an earlier text to be predicted with") {
  Dialogue d;
  d.begin();
  std::string const fit =
      "post = fit oscillator to bench.train with mh(samples = 400, burn_in = 200, thin = 2, chains = 2), seed = 1";
  REQUIRE_MESSAGE(d.enter(fit), d.messages());
  REQUIRE_MESSAGE(d.enter("parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11); 1 [kg]*y'' + c*y' + k*y + k3*y^3 = x"), d.messages());
  d.workbench().interrupt_after(1);
  REQUIRE_MESSAGE(d.enter(fit), d.messages());
  // The draws of the model without k3 stand in the folder yet.
  CHECK_FALSE(d.enter("count(k)"));
  CHECK_FALSE(d.enter("forecast = predict post on bench with draws(20)"));
  CHECK_MESSAGE(has(d.messages(), "post`"), d.messages());
  REQUIRE_MESSAGE(d.enter("resume post"), d.messages());
  CHECK_MESSAGE(d.enter("forecast = predict post on bench with draws(20)"), d.messages());
  CHECK(d.enter("mean(k3)"));
}

TEST_CASE("a fit that is stopped where a file of an earlier result cannot be read goes on all the same") {
  Dialogue d;
  d.begin();
  std::string const fit = "post = fit oscillator to bench.train with map";
  REQUIRE_MESSAGE(d.enter(fit), d.messages());
  REQUIRE_MESSAGE(d.enter("parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11); 1 [kg]*y'' + c*y' + k*y + k3*y^3 = x"), d.messages());
  std::filesystem::path const table = d.folder() / "results/post/predict.csv";
  REQUIRE(std::filesystem::remove(table));
  REQUIRE(::mkfifo(table.c_str(), 0600) == 0);
  d.workbench().interrupt_after(1);
  REQUIRE_MESSAGE(d.enter(fit), d.messages());
  CHECK_FALSE(d.enter("count(k)"));
  REQUIRE_MESSAGE(d.enter("resume post"), d.messages());
  CHECK(d.enter("mean(k3)"));
  CHECK(std::filesystem::is_regular_file(table));
}

TEST_CASE("what a task has left is forgotten as a whole") {
  repl::TaskResults results;
  for (char const* name : {"first", "second"}) {
    results.all.emplace_back().task = name;
    results.fitted[name] = {};
    results.selected[name] = {};
  }
  results.erase("first");
  CHECK(results.find("first") == nullptr);
  CHECK(results.fitted.count("first") + results.selected.count("first") == 0);
  CHECK(results.find("second") != nullptr);
  CHECK(results.fitted.count("second") + results.selected.count("second") == 2);
}

TEST_CASE("a file is loaded, changed, loaded again; its paths are those of its folder") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("save " + d.path("sub.sysid")));
  Dialogue other;
  REQUIRE_MESSAGE(other.enter("load " + d.path("sub.sysid")), other.messages());
  CHECK(has(other.messages(), "model oscillator"));
  REQUIRE_MESSAGE(other.enter("first = fit oscillator to bench.train with map"), other.messages());
  write_file(d.path("sub.sysid"), read_file(d.path("sub.sysid")) + "\nlast = fit oscillator to bench with map, seed = 1\n");
  REQUIRE(other.enter("reload"));
  CHECK(other.workbench().work().find("last") < other.workbench().work().items.size());
  REQUIRE(other.enter("list"));
  CHECK(has(other.answers(), "not run"));
  REQUIRE(other.enter("run"));
  REQUIRE(other.enter("show last"));
  CHECK(has(other.answers(), "last: fit oscillator"));
  REQUIRE(other.enter("drop last"));
  CHECK_FALSE(other.enter("show last"));
}

TEST_CASE("a narrow screen wraps what tasks say, and neither sources nor tables") {
  Dialogue wide, narrow(50);
  std::string const comment = "# a comment of more words than a line of fifty columns has room for\n";
  for (Dialogue* d : {&wide, &narrow}) {
    d->begin();
    REQUIRE(d->enter(comment + "function twice(a) = 2*a"));
    REQUIRE_MESSAGE(d->enter("first = fit oscillator to bench.train with map"), d->messages());
  }
  CHECK(has(wide.answers(), "chi_squared_per_sample"));
  auto const widest = [](std::string const& text) {
    std::istringstream lines(text);
    std::size_t most = 0;
    for (std::string line; std::getline(lines, line);) most = std::max(most, line.size());
    return most;
  };
  CHECK(widest(wide.answers()) > 80);
  CHECK(widest(narrow.answers()) < 60);
  for (char const* entry : {"show oscillator", "show twice", "list"}) {
    CAPTURE(entry);
    for (Dialogue* d : {&wide, &narrow}) REQUIRE(d->enter(entry));
    CHECK(wide.answers() == narrow.answers());
  }
  REQUIRE(narrow.enter("list kernels"));
  CHECK(widest(narrow.answers()) < 75);  // a signature
  CHECK(has(narrow.answers(), "\n    "));
}

TEST_CASE("from a pipe nothing is repeated, and the exit code says whether an entry has failed") {
  auto const exit = [](std::string const& text, std::string* answers = nullptr) {
    Dialogue d;
    std::istringstream in(text);
    int const code = repl::read_entries(in, d.workbench());
    if (answers != nullptr) *answers = d.answers();
    return code;
  };
  std::string answers;
  CHECK(exit(oscillator + "show oscillator\n", &answers) == 0);
  CHECK(has(answers, "model oscillator {"));
  CHECK_FALSE(has(answers, "sysid>"));
  CHECK(exit("help fit\nmean(k)\nhelp fit\n") == 1);
  CHECK(exit("quit\nmean(k)\n") == 0);
  CHECK(exit("model a {\n") == 1);
}

TEST_CASE("a command misspelt is told from a quantity, before any run and after one") {
  Dialogue d;
  d.begin();
  CHECK_FALSE(d.enter("qiut"));
  CHECK(has(d.messages(), "did you mean `quit`?"));
  CHECK_FALSE(d.enter("colums bench.csv"));
  CHECK(has(d.messages(), "did you mean `columns`?"));
  REQUIRE(d.enter("first = fit oscillator to bench.train with map"));
  CHECK_FALSE(d.enter("chek"));
  CHECK(has(d.messages(), "did you mean `check`?"));
  // A command of other prompts may be a quantity misspelt.
  CHECK_FALSE(d.enter("cd"));
  CHECK(has(d.messages(), "did you mean `c`? for the command: paths are relative"));
  CHECK_FALSE(d.enter("who"));
  CHECK(has(d.messages(), "write `list`"));
  CHECK_FALSE(has(d.messages(), "did you mean"));
}

TEST_CASE("a damaged table of draws is named, not read as numbers that are missing") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("first = fit oscillator to bench.train with map"));
  std::filesystem::path const draws = d.folder() / "results/first/draws_1.csv";
  std::string const text = read_file(draws);
  write_file(draws, text.substr(0, text.rfind(',')) + "\n");  // a row that lost its last number
  CHECK_THROWS_WITH_AS(repl::read_result(draws.parent_path(), "first", TaskKind::fit),
                       doctest::Contains("has been changed since it was written"), UserError);
}

TEST_CASE("a table of bands that has lost their means is named, also where its digest has been changed with it") {
  Dialogue d;
  d.begin();
  REQUIRE(d.enter("first = fit oscillator to bench.train with map"));
  std::filesystem::path const folder = d.folder() / "results/first";
  std::string table = read_file(folder / "predict.csv");
  std::string const column = "displacement_mean";
  REQUIRE(has(table, column));
  write_file(folder / "predict.csv", table.replace(table.find(column), column.size(), "displacement_mode"));
  auto summary = nlohmann::ordered_json::parse(read_file(folder / "summary.json"));
  summary["versions"]["files"]["predict.csv"] = sha256(table);
  summary["versions"]["summary_sha256"] = unsealed();
  write_file(folder / "summary.json", sealed_summary(summary.dump(2) + "\n"));
  CHECK_THROWS_WITH_AS(repl::read_result(folder, "first", TaskKind::fit), doctest::Contains("predict.csv` is damaged"), UserError);
}

TEST_CASE("a warning is shown once for each statement that it stands in, whatever moves before it") {
  Dialogue d;
  std::string const rest =
      "  state y [m]\n  initial y = 1\n  y' = -y/1 [s]\n  observe z ~ normal(y, sd = 1 [m])\n  parameter k ~ normal(0, sd = 1)\n}";
  d.enter("model a {\n" + rest);
  CHECK(has(d.messages(), "uses the parameter `k`"));
  d.enter("model b {\n" + rest);
  CHECK(has(d.messages(), "uses the parameter `k`"));
  d.enter("model c {\n  state y [m]\n  initial y = 1\n  y' = -y/1 [s]\n  observe z ~ normal(y, sd = 1 [m])\n}");
  CHECK_FALSE(has(d.messages(), "uses the parameter `k`"));
  write_file(d.path("loaded.sysid"), "# a comment\nmodel d {\n" + rest + "\n");
  d.enter("load " + d.path("loaded.sysid"));
  CHECK(has(d.messages(), "uses the parameter `k`"));
  d.enter("model e {\n  state y [m]\n  initial y = 1\n  y' = -y/1 [s]\n  observe z ~ normal(y, sd = 1 [m])\n}");
  CHECK_FALSE(has(d.messages(), "uses the parameter `k`"));
}

TEST_CASE("what the messages of the prompt name can be typed there") {
  Dialogue d;
  d.enter("use nothing_of_that_name");
  CHECK(has(d.messages(), "`list modules` lists the standard library"));
  CHECK_FALSE(has(d.messages(), "sysid list"));
  CHECK_FALSE(has(d.messages(), "sysid explain"));
}

TEST_CASE("a fit without a name is refitted after its model has changed, and entered again it replaces nothing") {
  Dialogue d;
  d.begin();
  REQUIRE_MESSAGE(d.enter("fit oscillator to bench.train with map"), d.messages());
  REQUIRE_MESSAGE(d.enter("parameter k [N/m] ~ log_uniform(1e3, 1e6)"), d.messages());
  REQUIRE_MESSAGE(d.enter("fit oscillator to bench.train with map"), d.messages());
  CHECK(has(d.messages(), "`fit_oscillator` is an earlier task, which is kept: the new task is called `fit_oscillator2`"));
  REQUIRE_MESSAGE(d.enter("refit fit_oscillator"), d.messages());
  CHECK(has(d.messages(), "fit_oscillator3 = fit oscillator to bench.train with map"));
}

TEST_CASE("a fit is given a disturbance at the prompt, as statements of the session") {
  Dialogue d;
  d.begin();
  CHECK_FALSE(d.enter("disturb"));
  CHECK(has(d.messages(), "no fit has been run yet"));
  REQUIRE_MESSAGE(d.enter("first = fit oscillator to bench.train with map"), d.messages());
  REQUIRE_MESSAGE(d.enter("disturb"), d.messages());
  CHECK(has(d.messages(), "model oscillator_with_disturbance {"));
  CHECK(has(d.messages(), "= x + unmeasured"));
  CHECK(has(d.messages(), "first_with_disturbance = fit oscillator_with_disturbance to bench.train with map"));
  CHECK(has(d.answers(), "log Bayes factor"));
  CHECK(has(d.answers(), "what the disturbance changes"));
  // What it has entered are statements like any other.
  REQUIRE_MESSAGE(d.enter("ahead = predict first_with_disturbance on bench.train"), d.messages());
  CHECK_FALSE(d.enter("disturb first_with_disturbance"));
  CHECK(has(d.messages(), "already has a disturbance"));
  CHECK_FALSE(d.enter("disturb nothing"));
  CHECK(has(d.messages(), "`nothing` is not a fit that has been run"));
}

TEST_CASE("what is entered before a task stays when the task cannot be run") {
  Dialogue d;
  d.begin();
  std::string const block =
      "data other { file \"" + d.path("none.csv") + "\"; time t [s]; input x = x [N] hold linear; measure displacement = y [m] }";
  CHECK_FALSE(d.enter(block + "\nlate = fit oscillator to other with map"));
  CHECK(d.enter("show other"));
  CHECK(has(d.answers() + d.messages(), "none.csv"));
  CHECK_FALSE(d.enter("show late"));
}

TEST_CASE("a record that was simulated is no prediction, whatever it is called") {
  Dialogue d;
  d.begin();
  REQUIRE_MESSAGE(d.enter("predicted = simulate maker with input x = gaussian(sd = 10), samples = 50, rate = 500 [Hz], seed = 2"),
                  d.messages());
  REQUIRE(d.workbench().results().back().task == "predicted");
  CHECK(d.workbench().results().back().kind == TaskKind::simulate);
  CHECK(d.workbench().results().back().records.empty());
}

TEST_CASE("the list has tasks with their back ends, whatever they are called") {
  Dialogue d;
  d.begin();
  REQUIRE_MESSAGE(d.enter("mypredict = fit oscillator to bench.train with map, substeps = 2"), d.messages());
  REQUIRE_MESSAGE(d.enter("forecast = predict mypredict on bench with draws(1)"), d.messages());
  REQUIRE(d.enter("list"));
  CHECK(has(d.answers(), "mypredict = fit oscillator to bench.train with map "));
  CHECK(has(d.answers(), "forecast = predict mypredict on bench "));
  CHECK(has(d.answers(), "made = simulate maker "));
  CHECK_FALSE(has(d.answers(), "substeps"));
  CHECK_FALSE(has(d.answers(), "with draws"));
  CHECK_FALSE(has(d.answers(), "with input"));
}

TEST_CASE("a plot or a statistic by the name that other prompts give it is answered with ours") {
  Dialogue d;
  d.begin();
  CHECK_FALSE(d.enter("hist(k)"));
  CHECK(has(d.messages(), "write `plot(histogram(k))`"));
  CHECK_FALSE(d.enter("std(k)"));
  CHECK(has(d.messages(), "write `sd(k)`"));
  CHECK_FALSE(d.enter("sd(k)"));
  CHECK_FALSE(has(d.messages(), "write `"));
}

TEST_CASE("a fit without a name of a model with arguments can be run and refitted") {
  Dialogue d;
  d.begin();
  REQUIRE_MESSAGE(d.enter("model law(n = 3) {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n"
                          "parameter k [N/m] ~ log_uniform(1e3, 1e5)\n parameter kn [N/m^n] ~ log_uniform(1, 1e10)\n"
                          "1 [kg]*y'' + 20 [N s/m]*y' + k*y + kn*y^n = x\n observe displacement ~ normal(y, sd = 1e-5) }"),
                  d.messages());
  REQUIRE_MESSAGE(d.enter("fit law to bench.train with map"), d.messages());
  REQUIRE_MESSAGE(d.enter("fit law(n = 2) to bench.train with map"), d.messages());
  CHECK(d.enter("show fit_law2"));
  // What they ran on is kept when the model changes, and compared under that name.
  REQUIRE_MESSAGE(d.enter("parameter k [N/m] ~ log_uniform(1e3, 1e6)"), d.messages());
  REQUIRE_MESSAGE(d.enter("compare"), d.messages());
  CHECK_MESSAGE(has(d.answers(), "law_1(n = 2)"), d.answers());
}
