// An interruption at any safe point ends with 75 or not at all, never with a crash, from the first poll of the search on.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "app/running.hpp"

using namespace sysid;

TEST_CASE("an interruption at each of the first hundred safe points is answered with 75") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const text = with(read_file(name), "rows 1..500, test", "rows 1..60, test");
  for (std::uint64_t poll = 1; poll <= 100; poll += 3) {
    CAPTURE(poll);
    TemporaryFolder folder;
    RunOptions options;
    options.output = folder.path() / "results";
    options.interrupt_after = poll;
    RunResult const result = run_text(name, text, options, {"fit"});
    clear_interrupt();
    CHECK(result.exit == 75);
  }
}

TEST_CASE("a run that drew its seed goes on with that seed") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string text = with(read_file(name), "rows 1..500, test", "rows 1..60, test");
  text =
      with(with(text, "chains = 4), seed = 1", "chains = 4)"), "samples = 25000, burn_in = 5000", "samples = 2000, burn_in = 500");
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  options.interrupt_after = 500;
  CHECK(run_text(name, text, options, {"fit"}).exit == 75);
  clear_interrupt();
  options.interrupt_after = 0;
  options.resume = true;
  CHECK(run_text(name, text, options, {"fit"}).exit != 75);
}

namespace {

/// Asks for an interruption when a job of that name begins, or ends.
class Interrupting : public Progress {
 public:
  Interrupting(std::string job, bool at_end) : job_(std::move(job)), at_end_(at_end) {}
  void begin(std::string_view what, std::uint64_t) override {
    now_ = what.starts_with(job_);
    if (now_ && !at_end_) request_interrupt();
  }
  void advance(std::uint64_t, std::string_view) override {}
  void end(bool) override {
    if (now_ && at_end_) request_interrupt();
  }

 private:
  std::string job_;
  bool at_end_, now_ = false;
};

}  // namespace

TEST_CASE("an interruption while the solver is chosen, or while the result is checked, is answered before a result is written") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const text = with(with(read_file(name), "rows 1..500, test", "rows 1..60, test"), "samples = 25000, burn_in = 5000",
                                "samples = 2000, burn_in = 500");
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "unbroken";
  run_text(name, text, options, {"fit"});
  for (auto const& [job, at_end] : {std::pair("trying 2 integrator steps", false), std::pair("sampling", true)}) {
    CAPTURE(job);
    options.output = folder.path() / job;
    options.resume = false;
    Interrupting progress(job, at_end);
    RunResult const broken = run_text(name, text, options, {"fit"}, &progress);
    clear_interrupt();
    CHECK(broken.exit == 75);
    CHECK(!std::filesystem::exists(options.output / "posterior/summary.json"));
    options.resume = true;
    run_text(name, text, options, {"fit"});
    for (char const* file : {"summary.json", "draws_1.csv"})
      CHECK(read_file(options.output / "posterior" / file) == read_file(folder.path() / "unbroken/posterior" / file));
  }
}

TEST_CASE("an interruption while the bands of a selection are computed is answered, and the selection goes on to the same bytes") {
  std::string rows = "t,y\n";
  for (int i = 0; i < 40; ++i) rows += fmt::format("{},{}\n", i, 3 * std::exp(-0.1 * i) + (i % 3 - 1) * 0.05);
  auto const decay = [](std::string const& name, std::string const& law) {
    return "model " + name + " {\n  state y\n  initial y = 3\n  parameter a [1/s] ~ log_uniform(0.01, 1)\n  y' = -a*" + law +
           "\n  observe level ~ normal(y, sd = 0.05)\n}\n";
  };
  std::string const text =
      decay("linear", "y") + decay("quadratic", "y^2") +
      "data record { file \"decay.csv\"; time t [s]; measure level = y }\ncandidates laws { linear; quadratic }\n"
      "selection = select laws to record with reversible_jump(samples = 400, burn_in = 100, pilot = 200), seed = 1\n";
  TemporaryFolder folder;
  write_file(folder.path() / "decay.csv", rows);
  RunOptions options;
  options.output = folder.path() / "unbroken";
  run_text(folder.path() / "case.sysid", text, options);
  options.output = folder.path() / "broken";
  Interrupting progress("jumping between models", true);
  CHECK(run_text(folder.path() / "case.sysid", text, options, {}, &progress).exit == 75);
  clear_interrupt();
  CHECK(!std::filesystem::exists(options.output / "selection/summary.json"));
  options.resume = true;
  run_text(folder.path() / "case.sysid", text, options);
  for (char const* file : {"summary.json", "predict.csv", "draws_linear.csv"}) {
    CAPTURE(file);
    CHECK(read_file(options.output / "selection" / file) == read_file(folder.path() / "unbroken/selection" / file));
  }
}

TEST_CASE("what a killed run left half written is removed by the next, and files of other names stay") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const text = with(with(read_file(name), "rows 1..500, test", "rows 1..60, test"), "samples = 25000, burn_in = 5000",
                                "samples = 600, burn_in = 200");
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  std::filesystem::path const results = options.output / "posterior";
  std::filesystem::create_directories(results / "figures");
  std::vector<std::string> const left = {"checkpoint.cbor.partial", "claim.partial", "draws_7.csv.partial", "summary.json.partial",
                                         "figures/gone.svg.partial"};
  std::vector<std::string> const others = {"notes.partial", "notes.txt.partial", "figures/mine.partial"};
  for (auto const* names : {&left, &others})
    for (std::string const& each : *names) write_file(results / each, "half");
  options.resume = true;
  CHECK(run_text(name, text, options, {"fit"}).exit != 75);
  for (std::string const& each : left) CHECK_MESSAGE(!std::filesystem::exists(results / each), each);
  for (std::string const& each : others) CHECK_MESSAGE(std::filesystem::exists(results / each), each);
}

TEST_CASE("a fit that is interrupted in its search goes on from there, to the same bytes") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const rows = with(read_file(name), "rows 1..500, test", "rows 1..60, test");
  std::string const chains = with(rows, "samples = 25000, burn_in = 5000", "samples = 2000, burn_in = 500");
  for (std::string const& text : {chains, with(chains, "mh(samples = 2000, burn_in = 500, thin = 10, chains = 4)", "map"),
                                  with(chains, "mh(samples = 2000, burn_in = 500, thin = 10, chains = 4)", "ml")}) {
    TemporaryFolder folder;
    RunOptions options;
    options.output = folder.path() / "unbroken";
    run_text(name, text, options, {"fit"});
    for (std::uint64_t const poll : {5, 23, 67}) {
      CAPTURE(poll);
      options = {};
      options.output = folder.path() / std::to_string(poll);
      options.checkpoint_interval = 0;
      options.interrupt_after = poll;
      RunResult const broken = run_text(name, text, options, {"fit"});
      clear_interrupt();
      REQUIRE(broken.exit == 75);
      CHECK(broken.notices.find("continues from there") != std::string::npos);
      REQUIRE(std::filesystem::exists(options.output / "posterior/checkpoint.cbor"));
      options.interrupt_after = 0;
      options.resume = true;
      options.checkpoint_interval = RunOptions().checkpoint_interval;  // it has its checkpoint, and needs no more of them
      RunResult const resumed = run_text(name, text, options, {"fit"});
      CHECK(resumed.notices.find("continuing from the checkpoint") != std::string::npos);
      CHECK_FALSE(std::filesystem::exists(options.output / "posterior/checkpoint.cbor"));
      for (char const* file : {"summary.json", "draws_1.csv"})
        CHECK(read_file(options.output / "posterior" / file) == read_file(folder.path() / "unbroken/posterior" / file));
    }
  }
}

TEST_CASE("two records made in one run with one seed differ, and neither is overwritten unasked") {
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const text = read_file(name);
  auto const line = text.find("truth     = simulate");
  std::string const second = with(text.substr(line, text.find("\nposterior", line) - line), "truth ", "other ");
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(name, text + second + "\n", options, {"simulate"});
  std::string const a = read_file(options.output / "truth/duffing_1pct.csv"),
                    b = read_file(options.output / "other/duffing_1pct.csv");
  CHECK(a.substr(a.find("\nt,")) != b.substr(b.find("\nt,")));
  CHECK_THROWS_AS(run_text(name, text + second + "\n", options, {"simulate"}), UserError);
}
