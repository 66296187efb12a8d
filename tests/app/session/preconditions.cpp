// Data of all tasks are looked at before the first task begins.
#include <doctest/doctest.h>

#include "app/answer.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const decay_model =
    "model decay {\n  state y\n  initial y = 1\n  parameter k ~ log_uniform(0.1, 10)\n  y' = -k*y\n"
    "  observe size ~ normal(y, sd = 0.1)\n}\n";
std::string const dish = "data dish {\n  file \"data/growth.csv\"\n  time t [s]\n  measure size = y\n}\n";
std::string const fit = "posterior = fit decay to dish with mh(samples = 60, burn_in = 20, thin = 1, chains = 2), seed = 1\n";

Answer run_to(std::string const& text, std::filesystem::path const& output, RunOptions options = {}) {
  WorkingFolder const here(error_examples);
  return answer("example.sysid", text, Depth::run, output, std::move(options));
}

}  // namespace

TEST_CASE("mistakes in the data of any task are all reported before the first task begins") {
  TemporaryFolder const output;
  std::string const missing = "data gone { file \"data/gone.csv\"; time t [s]; measure size = y }\n";
  std::string const beyond = "data cut { file \"data/growth.csv\"; time t [s]; measure size = y; split late = rows 5..9999 }\n";
  Answer const shown =
      run_to(decay_model + dish + missing + beyond + fit + "a = predict posterior on gone with draws(5)\n" +
                 "b = predict posterior on cut.late with draws(5)\n" + "c = predict posterior on gone with draws(6)\n",
             output.path());
  CHECK(shown.exit == ExitCode::user_error);
  CHECK(count(shown.messages, "error[E4018]") == 1);
  CHECK(count(shown.messages, "error[E4016]") == 1);
  CHECK_FALSE(std::filesystem::exists(output.path() / "posterior"));
}

TEST_CASE("files that cannot be read are an input error of their own") {
  TemporaryFolder const output;
  std::string const missing = "data dish { file \"data/gone.csv\"; time t [s]; measure size = y }\n";
  CHECK(run_to(decay_model + missing + fit, output.path()).exit == ExitCode::io);
}

TEST_CASE("old results outlive a forced run whose data cannot be read") {
  TemporaryFolder const output;
  REQUIRE(run_to(decay_model + dish + fit, output.path()).exit <= ExitCode::doubtful);
  std::string const before = content(output.path() / "posterior" / "draws_1.csv");
  REQUIRE_FALSE(before.empty());
  RunOptions options;
  options.force = true;
  std::string const beyond = "data late { file \"data/growth.csv\"; time t [s]; measure size = y; split end = rows 5..9999 }\n";
  CHECK(run_to(decay_model + dish + beyond + fit + "a = predict posterior on late.end with draws(5)\n", output.path(), options)
            .exit == ExitCode::user_error);
  CHECK(content(output.path() / "posterior" / "draws_1.csv") == before);
}

TEST_CASE("a file without tasks says which it could have") {
  WorkingFolder const here(error_examples);
  Source source("example.sysid", decay_model + dish);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE(file);
  TemporaryFolder const output;
  RunOptions options;
  options.output = output.path();
  SilentProgress progress;
  std::ostringstream summaries, notices;
  CHECK(run_tasks(source, *file, {}, options, progress, summaries, notices) == ExitCode::usage);
  CHECK(notices.str() == "there is no task in example.sysid\nhelp: add one, for example `posterior = fit decay to dish with mh`\n");
  notices.str("");
  CHECK(run_tasks(source, *file, {"simulate"}, options, progress, summaries, notices) == ExitCode::usage);
  std::size_t const task = notices.str().find("`truth = "), end = notices.str().rfind('`');
  REQUIRE(task < end);
  // As it is told it is taken.
  Source with_task("example.sysid", decay_model + dish + notices.str().substr(task + 1, end - task - 1) + "\n");
  CHECK(load(with_task, diagnostics));
  CHECK_FALSE(diagnostics.has_errors());
}

TEST_CASE("a selection that cannot begin is refused before the first task begins") {
  TemporaryFolder const output;
  std::string const flat =
      "model straight {\n  state y\n  initial y = 1\n  parameter rate [1/day] ~ flat()\n"
      "  parameter sigma ~ half_cauchy(scale = 1)\n  y' = -rate*y\n  observe size ~ normal(y, sd = sigma)\n}\n";
  std::string const select = "choice = select straight to dish with abc_smc(particles = 20), seed = 1\n";
  Answer const improper = run_to(decay_model + flat + dish + fit + select, output.path());
  CHECK(improper.exit == ExitCode::user_error);
  CHECK(count(improper.messages, "error[E6204]") == 1);
  CHECK(count(improper.messages, "`abc_smc` needs proper priors, but the prior of `rate` is flat") == 1);
  Answer const rising = run_to(
      decay_model + dish + fit + "choice = select decay to dish with abc_smc(schedule = (10, 20)), seed = 1\n", output.path());
  CHECK(rising.exit == ExitCode::user_error);
  CHECK(count(rising.messages, "error[E6203]") == 1);
  CHECK_FALSE(std::filesystem::exists(output.path() / "posterior"));
}

TEST_CASE("an improper prior of the noise is refused where the likelihood is asked beside the distance") {
  std::string const vague =
      "model decay {\n  state y\n  initial y = 1\n  parameter k ~ log_uniform(0.1, 10)\n"
      "  parameter level ~ flat()\n  y' = -k*y\n  observe size ~ normal(y, sd = exp(level))\n}\n";
  auto const refused = [&](std::string const& settings) {
    WorkingFolder const here(error_examples);
    Source source("example.sysid",
                  vague + dish + "choice = select decay to dish with abc_smc(particles = 20" + settings + "), seed = 1\n");
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE_MESSAGE(file, render(diagnostics, source));
    SilentProgress progress;
    std::ostringstream ignored;
    RunOptions const options;
    Session session(source, *file, options, progress, ignored, ignored);
    return count(render(check_preconditions(session, [](Task const&) { return true; }).diagnostics, source),
                 "the prior of `level` is flat");
  };
  CHECK(refused("") == 1);
  CHECK(refused(", cross_check = no") == 0);
}
