// `fit --with-disturbance` as a user runs it, on records that nothing of the program makes.
#include "app/disturbed/fit_disturbed.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "app/disturbed/shaken_record.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using namespace sysid::testing;
using json = nlohmann::json;

namespace {

bool contains(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

std::string const plain = R"(
model shaken {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(0.1, 10)
  parameter k [N/m] ~ log_uniform(40, 4000)
  m*y'' + c*y' + k*y = x
  observe d [m] ~ normal(y, sd = 2e-5)
}
data bench { file "b.csv"; time t [s]; input x = x [N] hold zero_order; measure d = y [m] }
post = fit shaken to bench with map, seed = 1
)";

struct Pair {
  TemporaryFolder folder;
  std::ostringstream out, notices;

  explicit Pair(std::string const& record) { write_file(folder.path() / "b.csv", record); }
  ExitCode run(std::string const& text = plain) {
    out.str("");
    notices.str("");
    Source source((folder.path() / "case.sysid").string(), text);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE(file);
    RunOptions options;
    options.output = folder.path() / "results";
    options.figures = false;
    SilentProgress silent;
    return fit_with_disturbance(source, *file, options, silent, out, notices);
  }
  /// After `run`.
  ExplainedShares shares() {
    Source source((folder.path() / "case.sysid").string(), plain);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE(file);
    RunOptions options;
    options.output = folder.path() / "results";
    SilentProgress silent;
    Session session(source, *file, options, silent, out, notices);
    return explained_shares(session, file->tasks.front(), options.output / "post_with_disturbance");
  }
  json summary(std::string const& task) const { return json::parse(read_file(folder.path() / "results" / task / "summary.json")); }
};

}  // namespace

TEST_CASE("a record with an unmeasured force prefers the disturbance, and the answer says what it changes") {
  Pair pair(shaken_record(5, 0.05, 400));
  pair.run();
  std::string const said = pair.out.str();
  INFO(said);
  CHECK(contains(said, "the record prefers the model with the disturbance: log Bayes factor +"));
  CHECK(contains(said, "unmeasured: "));
  CHECK(contains(said, "sd ratio"));
  // 0.05 N held over a sample.
  json const with = pair.summary("post_with_disturbance"), without = pair.summary("post");
  double const rms = parameter(with, "unmeasured_rms").at("mean");
  CHECK(std::abs(rms - 0.05) < 0.015);
  CHECK(parameter(without, "k").at("sd").get<double>() < 0.5 * parameter(with, "k").at("sd").get<double>());
  // By themselves the equations explain as much with the parameters of either fit.
  ExplainedShares const shares = pair.shares();
  REQUIRE((shares.without && shares.with));
  CHECK(*shares.without > 0.95);
  CHECK(*shares.with > 0.95);
  // The changed file lies beside its results; run from there it is that fit, and goes on to predictions.
  auto const path = pair.folder.path() / "results/post_with_disturbance/with_disturbance.sysid";
  CHECK(contains(pair.notices.str(), path.string()));
  RunOptions options;
  options.output = pair.folder.path() / "results";
  options.resume = true;
  RunResult const again = run_text(path, read_file(path), options);
  CHECK(contains(again.notices, "post_with_disturbance: complete, kept"));
  // Once more: nothing is fitted again, and the answer is the same.
  std::string const words = said.substr(said.find("the record prefers"));
  pair.run();
  CHECK(contains(pair.notices.str(), "post: complete, kept"));
  CHECK(contains(pair.out.str(), words));
}

TEST_CASE("a record without an unmeasured force does not prefer the disturbance") {
  Pair pair(shaken_record(6, 0, 400));
  pair.run();
  INFO(pair.out.str());
  CHECK_FALSE(contains(pair.out.str(), "prefers the model with the disturbance"));
}

TEST_CASE("a disturbance that stands in for a missing term is not recommended, and the term that is named passes with it") {
  Pair pair(shaken_record(7, 0.02, 500, 1e7));
  pair.run();
  std::string const said = pair.out.str();
  INFO(said);
  CHECK_FALSE(contains(said, "prefers the model with the disturbance"));
  CHECK(contains(said, "the disturbance stands in for a missing term"));
  auto const finding_of = [&](std::string const& task) {
    json const summary = pair.summary(task);
    for (json const& each : summary.at("findings"))
      if (each.at("code") == "disturbance_follows_states") return each;
    return json();
  };
  json const finding = finding_of("post_with_disturbance");
  REQUIRE_FALSE(finding.is_null());
  CHECK(finding.at("names") == json{"unmeasured"});
  CHECK(contains(finding.at("message"), "*y^3"));
  // As the help says.
  std::string const help = finding.at("help");
  std::size_t const line = help.find("`parameter extra") + 1;
  std::string const declared = help.substr(line, help.find('`', line) - line);
  CHECK(contains(declared, "[kg/(m^2 s^2)]"));
  std::string cured = plain;
  cured.replace(cured.find("  m*y''"), 0, "  " + declared + "\n");
  cured.replace(cured.find("= x\n"), 4, "= x + extra*y^3\n");
  std::filesystem::remove_all(pair.folder.path() / "results");
  pair.run(cured);
  INFO(pair.out.str());
  CHECK(finding_of("post_with_disturbance").is_null());
  json const extra = parameter(pair.summary("post_with_disturbance"), "extra");
  CHECK(std::abs(extra.at("mean").get<double>() + 1e7) < 4 * extra.at("sd").get<double>());
}

TEST_CASE("a fit whose model can have no disturbance is fitted without one where others can") {
  Pair pair(shaken_record(5, 0.05, 400));
  pair.run(plain + R"(
model heavy {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter k [N/m] ~ log_uniform(40, 4000)
  disturbance w [N] ~ white(intensity = 1e-5)
  1 [kg]*y'' + 1 [N s/m]*y' + k*y = x + w
  observe d [m] ~ normal(y, sd = 2e-5)
}
wide = fit heavy to bench with map, seed = 1
)");
  CHECK(contains(pair.notices.str(), "wide: fitted without a disturbance only: `heavy` already has a disturbance"));
  CHECK(std::filesystem::exists(pair.folder.path() / "results/wide/summary.json"));
}

TEST_CASE("a fit that does not move says nothing of how large a disturbance may be") {
  std::string still;
  for (int i = 0; i < 50; ++i) still += fmt::format("{},0,{}\n", 0.01 * i, 2e-5 * ((i * 37) % 11 - 5));
  Pair pair("t,x,y\n" + still);
  try {
    pair.run();
    FAIL("nothing was refused");
  } catch (UserError const& error) {
    CHECK(contains(error.diagnostic().message, "the size of a disturbance cannot be estimated"));
    CHECK(error.diagnostic().primary);
  }
}

TEST_CASE("disturbances of a model and of its part are told apart") {
  std::string const text = R"(
model leg {
  input base [m]
  state z [m]
  initial z = 0, z' = 0
  0.1 [kg]*z'' = 100 [N/m]*(base - z) - 0.2 [N s/m]*z'
  let force = 100 [N/m]*(base - z)
}
model rig {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  part joint = leg(base = y)
  parameter k [N/m] ~ log_uniform(40, 4000)
  1 [kg]*y'' + 1 [N s/m]*y' + k*y + joint.force = x
  observe d [m] ~ normal(y, sd = 2e-5)
}
data bench { file "b.csv"; time t [s]; input x = x [N] hold zero_order; measure d = y [m] }
post = fit rig to bench with map, seed = 1
)";
  Pair pair(shaken_record(5, 0.05, 400));
  pair.run(text);
  std::string const said = pair.out.str();
  INFO(said);
  auto const lines = [&](std::string const& start) {
    int count = 0;
    for (auto at = said.find(start); at != std::string::npos; at = said.find(start, at + 1)) ++count;
    return count;
  };
  CHECK(lines("\nunmeasured: ") == 1);
  CHECK(lines("\njoint.unmeasured: ") == 1);
}

TEST_CASE("a fit that would write over the results of another task is left as it is") {
  Pair pair(shaken_record(5, 0.05, 400));
  std::string const both = plain + "post_with_disturbance = fit shaken to bench with map, seed = 2\n";
  pair.run(both);
  CHECK(
      contains(pair.notices.str(),
               "post: fitted without a disturbance only: this fit with a disturbance would have the name `post_with_disturbance`"));
  CHECK(pair.summary("post_with_disturbance").at("seed") == 2);
  CHECK(contains(pair.out.str(), "\nunmeasured: "));  // of the other fit
}
