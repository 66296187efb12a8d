// `sysid check`: silent on what is sound, and naming what is planted: null directions, wild priors, coarse steps, data that are not
// there. SYSID_BLESS=1 rewrites the recorded pages.
#include "app/preflight/check_file.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "diagnostics/verdict.hpp"
#include "report/page/check_page.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "app/checking.hpp"
#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "relative.hpp"
#include "replications.hpp"

using namespace sysid;

namespace {

std::filesystem::path const golden_pages = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/check";

// The task that makes the shipped record, which has no values for parameters that a test adds.
std::string truth_task() {
  std::string const text = shipped("duffing/duffing.sysid");
  std::size_t const begin = text.find("\ntruth") + 1;
  return text.substr(begin, text.find("posterior", begin) - begin);
}

// The shipped text with the force's scale free as well.
std::string free_gain() {
  std::string const text = with(shipped("duffing/duffing.sysid"), "k3*y^3 = x", "k3*y^3 = b*x");
  return with(with(text, "  parameter c ", "  parameter b ~ log_uniform(0.1, 10)\n  parameter c "), truth_task(), "");
}

// The shipped text with a quadratic spring.
std::string quadratic() {
  std::string const text = with(shipped("silverbox/silverbox.sysid"), " + k3*y^3 =", " + k2*y^2 + k3*y^3 =");
  return with(text, "  parameter b ", "  parameter k2 [1/(V s^2)] ~ normal(0, sd = 1e6)\n  parameter b ");
}

std::string const bouc_wen = R"(
model loop {
  input x [N]
  state y [m], z [N]
  initial y = 0, y' = 0, z = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ uniform(0, 2e4)
  parameter A [N/m] ~ uniform(0, 2e4)
  parameter alpha [1/(N m)] ~ log_uniform(0.1, 10)
  parameter beta [1/(N m)] ~ uniform(-5, 5)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-4)
  m*y'' + c*y' + k*y + z = x
  z' = A*y' - alpha*abs(y')*abs(z)*z - beta*y'*abs(z)^2
  observe displacement [m] ~ normal(y, sd = sigma)
}
data bench {
  file "results/truth/loop.csv"
  time t [s]
  input x = x [N] hold zero_order
  measure displacement = displacement [m]
}
truth = simulate loop with values(m = 1, c = 20, k = 0, A = 6680, alpha = 1.5, beta = -1.5), input x = gaussian(sd = 10), noise = 1 [percent], samples = 1000, rate = 1000 [Hz], seed = 1, file = "loop.csv"
posterior = fit loop to bench with mh(), seed = 1
)";

}  // namespace

TEST_CASE("check finds nothing in any shipped model, whatever draws of the prior it looks at") {
  int count = 0, dictionaries = 0, preflights = 0;
  std::vector<std::optional<std::uint64_t>> seeds = {{}};  // of the file
  if (full_size()) seeds.emplace_back(2);
  for (auto const& entry : std::filesystem::recursive_directory_iterator(models)) {
    if (entry.path().extension() != ".sysid") continue;
    ++count;
    CAPTURE(entry.path().string());
    for (std::optional<std::uint64_t> const seed : seeds) {
      RunOptions options;
      options.seed = seed;
      CheckResult const result = checked(entry.path(), read_file(entry.path()), options);
      CHECK(result.diagnostics.all().empty());
      if (!seed) dictionaries += static_cast<int>(result.page.dictionaries.size());
      for (TaskPage const& page : result.page.tasks) {
        for (Finding const& finding : page.findings) FAIL_CHECK(page.name << ": " << finding.message);
        for (PreflightPage const& each : page.preflights) {
          ++preflights;
          for (Finding const& finding : each.findings) {
            // True of rivals, told as notes: with n = 4 and a negative beta the slope of z grows as its fourth power, so a fifth of
            // the prior is beyond what can be simulated; with n = 1 beta is small beside A/z, so little of it shows.
            bool const true_of_rival = (each.candidate == "bouc_wen(n = 4)" && finding.code == FindingCode::prior_fails) ||
                                       (each.candidate == "bouc_wen(n = 1)" && finding.code == FindingCode::barely_narrowed);
            // A stiffness that walks below zero lets the motion grow without bound.
            if (entry.path().filename() == "drift.sysid" && finding.code == FindingCode::prior_fails) continue;
            if (!true_of_rival || finding.severity != Severity::note)
              FAIL_CHECK(page.name << " " << each.candidate << ": " << finding.message);
          }
          if (each.not_examined.find("has a Gaussian process") != std::string::npos) continue;
          if (entry.path().filename() == "grey.sysid") {  // 43 parameters: more than a check has time for, and it says so
            CHECK(each.not_examined.find("43 parameters") != std::string::npos);
            continue;
          }
          CHECK(each.not_examined == "");
          REQUIRE(each.prior);
          CHECK(each.prior->draws == (entry.path().filename() == "ambient.sysid" ? 86 : 128));  // a long record
          // Within ten: a unit a thousand times too large or too small lies beyond the bar of a hundred, whichever model has it.
          for (PriorPage::Channel const& channel : each.prior->channels)
            CHECK(std::abs(std::log10(channel.middle / channel.measured)) < 1);
          CHECK(each.information->draws >= 2);
        }
      }
    }
  }
  CHECK(count >= 4);
  CHECK(2 * preflights >= 3 * static_cast<int>(seeds.size()) *
                              (count - dictionaries + 5));  // five candidates and two beside the fits; a discovery has none
}

TEST_CASE("steps too long for a prior's fast end are not a failing model; stated, they are a finding") {
  // Weekly rows, and rates of which most are above 1/day.
  CheckResult const chosen = checked(models / "sir/sir.sysid", shipped("sir/sir.sysid"));
  PriorPage const& prior = *preflight(chosen, "posterior").prior;
  CHECK(prior.failed_as_stated > 64);
  CHECK(prior.failed < 26);
  CHECK(check_text(chosen.page).find("only because the steps are too long") != std::string::npos);
  CHECK(check_text(chosen.page).find("one every 7 day") != std::string::npos);
  CheckResult const stated =
      checked(models / "sir/sir.sysid", with(shipped("sir/sir.sysid"), "chains = 4), seed", "chains = 4), substeps = 1, seed"));
  CHECK(messages(stated, "prior_fails").empty());
  REQUIRE(messages(stated, "integration_step").size() == 2);  // of the prior's draws, and of the result
  CHECK(messages(stated, "integration_step")[0].find("% of the prior draws overflow") != std::string::npos);
}

TEST_CASE("a vague prior that the data do not narrow is named, a narrow one is knowledge") {
  // What models/one_compartment/README.md says of the published priors.
  std::string const text =
      with(with(shipped("one_compartment/one_compartment.sysid"), "log_normal(median = 0.25, sd = 0.3)", "half_cauchy(scale = 1)"),
           "log_normal(median = 0.1, sd = 0.5)", "half_cauchy(scale = 1)");
  auto const said = messages(checked(models / "one_compartment/published.sysid", text), "barely_narrowed");
  REQUIRE(said.size() == 1);
  CHECK(
      said[0] ==
      "the data are expected to contain little information on K_m: expected sd 96 to 100 % of the prior's (at 8 of 8 prior draws)");
}

TEST_CASE("a ridge along which both parameters are narrowed is told, not warned of") {
  CheckResult const result = checked(models / "robertson/robertson.sysid", shipped("robertson/robertson.sysid"));
  InformationPage const& information = *preflight(result, "estimate").information;
  REQUIRE(information.ridges.size() == 1);
  CHECK(information.ridges[0].find(
            "k1 and k3 are nearly confounded, but both posteriors are expected to be narrower than the priors") == 0);
}

TEST_CASE("a model of the library and the parts of one's own are shown with their equations and priors") {
  TemporaryFolder folder;
  CheckResult const library = checked(folder.path() / "own.sysid", R"(
use oscillators
truth = simulate duffing with values(m = 1, c = 20, k = 1e4, k3 = 5e9, sigma = 1e-6), input x = gaussian(sd = 10), samples = 10, rate = 1000 [Hz]
)");
  ModelPage const& page = library.page.models.front();
  CHECK(page.equations == std::vector<std::string>{"m*y'' + c*y' + k*y + k3*y^3 = x"});
  CHECK(page.parameters.front().text == "~ log_uniform(0.001, 1000)");
  CHECK(page.channels.front().text == "~ normal(y, sd = sigma)");
  CheckResult const own = checked(models / "two_mass/two_mass.sysid", shipped("two_mass/two_mass.sysid"));
  std::string joint;
  for (DeclaredLine const& line : own.page.models.front().parameters)
    if (line.name == "joint.k") joint = line.text;
  CHECK(joint == "~ log_uniform(1, 1e6)");
}

TEST_CASE("disturbances and random starts have lines of their own, and are no unknowns") {
  TemporaryFolder folder;
  std::string const text = R"(
model mast {
  input x [N]
  state y [mm]
  initial y ~ normal(0, sd = 2), y' = 0
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  disturbance wind [N] ~ ornstein_uhlenbeck(sd = 0.3, time = 2)
  disturbance hum [N] ~ white(intensity = 0.1)
  1 [kg]*y'' + 20 [N s/m]*y' + k*y = x + wind + hum
  observe displacement ~ normal(y, sd = 1e-4)
}
model tank {
  time discrete 1 [s]
  input u
  state level
  initial level = 0
  parameter a ~ uniform(-1, 1)
  disturbance w ~ normal(0, sd = 0.1)
  level = a*lag(level, 1) + u + w + 0.5*lag(w, 1)
  observe output ~ normal(level, sd = 0.1)
}
)";
  CheckResult const result = checked(folder.path() / "own.sysid", text);
  ModelPage const& mast = result.page.models.at(0);
  CHECK(mast.unknowns == std::vector<std::string>{"y''"});
  REQUIRE(mast.states.size() == 1);
  CHECK(mast.states[0].text == "order 2, initial y ~ normal(0, sd = 2)");
  REQUIRE(mast.disturbances.size() == 2);
  CHECK(mast.disturbances[0].text == "~ ornstein_uhlenbeck(sd = 0.3, time = 2)");
  CHECK(mast.disturbances[1].unit == "N");
  ModelPage const& tank = result.page.models.at(1);
  CHECK(tank.unknowns == std::vector<std::string>{"level"});
  CHECK(tank.disturbances.at(0).text == "~ normal(0, sd = 0.1)");
  CHECK(check_text(result.page).find("  unmeasured  w  ") != std::string::npos);
  nlohmann::json const object = nlohmann::json::parse(check_json(result.page, ""));
  CHECK(object.at("models").at(0).at("disturbances").size() == 2);
}

TEST_CASE("the page of shipped models is the recorded one, and JSON holds the same") {
  bool const bless = std::getenv("SYSID_BLESS") != nullptr;
  for (char const* name : {"duffing/duffing", "silverbox/silverbox"}) {
    CAPTURE(name);
    CheckResult const result = checked(models / (std::string(name) + ".sysid"), shipped(std::string(name) + ".sysid"));
    std::string const page = without(check_text(result.page), models.string() + "/");
    auto const record = golden_pages / (std::filesystem::path(name).filename().string() + ".txt");
    if (bless) write_file(record, page);
    CHECK(page == read_file(record));
    nlohmann::json const object = nlohmann::json::parse(check_json(result.page, ""));
    CHECK(object.at("models").at(0).at("name") == result.page.models.front().name);
    CHECK(object.at("tasks").size() == result.page.tasks.size());
  }
}

TEST_CASE("a force of free scale makes Duffing's parameters a group that scales together") {
  CheckResult const result = checked(models / "duffing/gain.sysid", free_gain());
  auto const said = messages(result, "not_identifiable");
  REQUIRE(said.size() == 1);
  CHECK(said[0] == "scaling m, b, c, k and k3 together leaves displacement unchanged (at 8 of 8 prior draws)");
  CHECK(grade(result.page) == Severity::error);
}

TEST_CASE("of the Bouc-Wen benchmark's beta, gamma and delta only two products are known, which is named") {
  std::string text = shipped("bouc_wen_benchmark/bouc_wen_benchmark.sysid");
  text = with(text, "parameter beta_gamma [1/m]   ~ log_uniform(10, 1e4)",
              "parameter beta [1/m] ~ log_uniform(10, 1e4)\n  parameter gamma [-] ~ log_uniform(0.1, 10)");
  text = with(text, "parameter beta_delta [1/m]   ~ normal(0, sd = 1000)", "parameter delta [-] ~ normal(0, sd = 1)");
  text = with(with(text, "beta_gamma*abs(y')*z", "beta*gamma*abs(y')*z"), "beta_delta*y'*abs(z)", "beta*delta*y'*abs(z)");
  CheckResult const result = checked(models / "bouc_wen_benchmark/bouc_wen_benchmark.sysid", text);
  auto const found = messages(result, "not_identifiable");
  REQUIRE(found.size() == 1);
  CHECK(found.front().starts_with("scaling beta by s and gamma and delta by s^(-1) leaves displacement unchanged for any s"));
}

TEST_CASE("a quadratic spring beside both offsets of the Silverbox is one null direction of four parameters") {
  // Moving the origin of y by a: offset + a, k + 2 k2 a, k2 + 3 k3 a, u0 + (k/b) a leave the output as it was, whatever a.
  CheckResult const result = checked(models / "silverbox/quadratic.sysid", quadratic());
  auto const said = messages(result, "not_identifiable");
  REQUIRE(said.size() == 1);
  std::string const names = said[0].substr(0, said[0].find(" are confounded"));
  for (char const* name : {"k", "k2", "u0", "offset"})
    CHECK_MESSAGE((", " + with(names, " and ", ", ") + ",").find(std::string(", ") + name + ",") != std::string::npos, names);
}

TEST_CASE("a linear spring beside a Bouc-Wen loop is nearly confounded with the loop's own stiffness") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "loop.sysid", bouc_wen, options, {"simulate"});
  auto const said = messages(checked(folder.path() / "loop.sysid", bouc_wen, options), "nearly_confounded");
  REQUIRE(said.size() == 1);
  CHECK(said[0].find("k and A are nearly confounded: the data determine little more than k + A; ") == 0);
  // Without the spring nothing is confounded.
  std::string const without = with(with(bouc_wen, "parameter k [N/m] ~ uniform(0, 2e4)", "constant k [N/m] = 0"), "k = 0, ", "");
  CheckResult const sound = checked(folder.path() / "loop.sysid", without, options);
  CHECK(messages(sound, "nearly_confounded").empty());
  CHECK(messages(sound, "not_identifiable").empty());
}

// Three records of a line through the origin, whose slopes are a population.
std::string population(std::string const& members) {
  std::string text =
      "model group {\n  input u\n  parameter centre ~ normal(0, sd = 5)\n  parameter spread ~ half_normal(sd = 3)\n" + members +
      "  let slope = centre + spread*z\n  observe d ~ normal(slope*u, sd = 0.1)\n}\n";
  std::string blocks;
  for (char const* name : {"a", "b", "c"}) {
    text += std::string("data ") + name + " { file \"" + name + ".csv\"; input u = u; measure d = d }\n";
    blocks += (blocks.empty() ? "" : ", ") + std::string(name);
  }
  return text + "posterior = fit group to " + blocks + " with mh\n";
}

TEST_CASE("standardised members of a population are told apart by their prior, any others are not") {
  TemporaryFolder folder;
  int slope = 0;
  for (char const* name : {"a.csv", "b.csv", "c.csv"}) {
    std::string record = "u,d\n";
    ++slope;
    for (int i = 0; i < 10; ++i) record += std::to_string(i) + "," + std::to_string(slope * i) + "\n";
    write_file(folder.path() / name, record);
  }
  std::filesystem::path const file = folder.path() / "group.sysid";
  CheckResult const sound = checked(file, population("  parameter z per experiment ~ normal(0, sd = 1)\n"));
  CHECK(messages(sound, "not_identifiable").empty());
  CHECK(messages(sound, "nearly_confounded").empty());
  REQUIRE(preflight(sound, "posterior").information);
  CHECK_FALSE(preflight(sound, "posterior").information->ridges.empty());
  CheckResult const free = checked(file, population("  parameter z per experiment ~ normal(0, sd = 20)\n"));
  CHECK_FALSE(messages(free, "not_identifiable").empty());
}

TEST_CASE("what has no influence is said, and apart from it what is used nowhere") {
  std::string const text = with(shipped("duffing/duffing.sysid"), "  parameter c ",
                                "  parameter idle ~ normal(0, sd = 1)\n  parameter late ~ log_uniform(1, 10)\n  parameter c ");
  std::string const never = with(with(text, "k3*y^3 = x", "k3*y^3 + late*max(abs(y) - 1, 0) = x"), truth_task(), "");
  auto const said = messages(checked(models / "duffing/idle.sysid", never), "not_identifiable");
  REQUIRE(said.size() == 1);
  CHECK(said[0] == "late has no influence on displacement with this input (at 8 of 8 prior draws)");
}

TEST_CASE("a parameter that nothing reads is told by the checker alone, one that only derived quantities read by its name") {
  std::string const text =
      with(with(shipped("duffing/duffing.sysid"), "  parameter c ", "  parameter idle ~ normal(0, sd = 1)\n  parameter c "),
           truth_task(), "");
  CheckResult const unread = checked(models / "duffing/idle.sysid", text);
  CHECK(messages(unread, "not_identifiable").empty());
  std::string instead;
  for (InformationPage::Line const& line : preflight(unread, "posterior").information->lines)
    if (line.name == "idle") instead = line.instead;
  CHECK(instead == "not used");
  CheckResult const derived =
      checked(models / "duffing/idle.sysid", with(text, "  parameter c ", "  derive twice = 2*idle\n  parameter c "));
  CHECK(messages(derived, "not_identifiable") ==
        std::vector<std::string>{"only derived quantities depend on idle: the data contain no information on it"});
}

TEST_CASE("a map has no solver to refine and no rule between samples, and an equation for each state") {
  TemporaryFolder folder;
  std::string table = "t,x,o\n";
  double y = 0, z = 0, earlier = 0, x = 0;
  for (int i = 0; i < 50; ++i) {
    double const input = i % 7 - 3, next = 0.5 * y + x + 0.1 * (0.5 * earlier + input);
    earlier = z, z = 0.5 * earlier + input, x = input, y = next;
    table += std::to_string(i) + "," + std::to_string(input) + "," + std::to_string(y) + "\n";
  }
  write_file(folder.path() / "map.csv", table);
  std::string const text = R"(
model map {
  time discrete 1 [s]
  input x
  state y, z
  initial y = 0, z = 0
  parameter a ~ normal(0, sd = 1)
  y = a*lag(y, 1) + lag(x, 1) + 0.1*z
  z = 0.5*lag(z, 2) + x
  observe o ~ normal(y, sd = 0.001)
}
data bench { file "map.csv"; time t [s]; input x = x; measure o = o }
found = fit map to bench with map
)";
  CheckResult const result = checked(folder.path() / "map.sysid", text);
  InformationPage const& information = *preflight(result, "found").information;
  CHECK(information.moves.empty());
  TaskPage const& page = task(result, "found");
  CHECK(page.all_findings().empty());
  CHECK(page.coverage.at(0).inputs.at(0).rule.empty());
  std::string const shown = check_text(result.page);
  CHECK(shown.find("substeps") == std::string::npos);
  CHECK(shown.find("2 equations for 2 unknowns: y, z") != std::string::npos);
  CHECK(shown.find("input x: 99 %") != std::string::npos);
}

TEST_CASE("algebraic states are among the unknowns of a model") {
  CheckResult const result = checked(models / "pendulum/pendulum.sysid", shipped("pendulum/pendulum.sysid"));
  CHECK(result.page.models.front().unknowns == std::vector<std::string>{"x''", "y''", "pull"});
}

TEST_CASE("expected knowledge is that of the prediction rule of the task") {
  // o_i = 0.5^i. Free run: prediction a^i with slope i a^(i-1), sum of squares (1 + a^2)/(1 - a^2)^3. One step ahead: slope
  // o_(i-1), sum 1/(1 - a^2). Noise 0.001, and a within 0.04 of 0.5 at the draws looked at.
  TemporaryFolder folder;
  std::string table = "t,o\n";
  double value = 1;
  for (int i = 0; i < 30; ++i, value /= 2) table += std::to_string(i) + "," + std::to_string(value) + "\n";
  write_file(folder.path() / "decay.csv", table);
  std::string const text = R"(
model decay {
  time discrete 1 [s]
  parameter a ~ normal(0.5, sd = 0.02)
  observe o ~ normal(a*lag(measured(o), 1), sd = 0.001)
}
data bench { file "decay.csv"; time t [s]; measure o = o }
ahead = fit decay to bench with map
free = fit decay to bench with map, prediction = free_run
)";
  CheckResult const result = checked(folder.path() / "decay.sysid", text);
  auto const expected = [&](std::string const& name) { return preflight(result, name).information->lines.at(0); };
  double const ahead = 0.001 / std::sqrt(1 / (1 - 0.25));
  CHECK(expected("ahead").low == relative(ahead, 0.01));
  CHECK(expected("ahead").high == relative(ahead, 0.01));
  auto const free = [](double a) { return 0.001 / std::sqrt((1 + a * a) / std::pow(1 - a * a, 3)); };
  CHECK(expected("free").low > free(0.56));
  CHECK(expected("free").high < free(0.44));
  CHECK(free(0.44) < ahead);
}

TEST_CASE("a sample that is missing in an autoregression costs the rows that read it, not the look at the others") {
  TemporaryFolder folder;
  std::string table = "t,o\n";
  std::vector<double> y;
  double square = 0;
  for (int i = 0; i < 60; ++i) y.push_back(std::sin(0.7 * i) + 0.3 * std::cos(2.1 * i));
  for (std::size_t i = 0; i < y.size(); ++i) {
    table += std::to_string(i) + "," + (i == 20 ? std::string() : std::to_string(y[i])) + "\n";
    if (i > 0 && i != 20 && i != 21) square += y[i - 1] * y[i - 1];
  }
  write_file(folder.path() / "gap.csv", table);
  CheckResult const result = checked(folder.path() / "gap.sysid", R"(
model wave {
  time discrete 1 [s]
  parameter a ~ normal(0, sd = 2)
  observe o ~ normal(a*lag(measured(o), 1), sd = 0.1)
}
data bench { file "gap.csv"; time t [s]; measure o = o }
best = fit wave to bench with map
)");
  PreflightPage const& page = preflight(result, "best");
  CHECK(page.not_examined == "");
  REQUIRE(page.information);
  CHECK(page.information->lines.at(0).low == relative(0.1 / std::sqrt(square), 1e-3));
}

TEST_CASE("data in another unit than they were recorded in are seen in the prior's predictions") {
  std::string const text =
      with(shipped("duffing/duffing.sysid"), "displacement = displacement [m]", "displacement = displacement [km]");
  auto const said = messages(checked(models / "duffing/unit.sysid", text), "prior_far_from_data");
  REQUIRE(said.size() == 1);
  CHECK(said[0].find("displacement") != std::string::npos);
  CHECK(said[0].find("smaller") != std::string::npos);
}

TEST_CASE("millimetres declared as metres are seen, and metres declared as millimetres") {
  std::string const text = shipped("duffing/duffing.sysid");
  auto const smaller = messages(
      checked(models / "duffing/unit.sysid", with(text, "displacement = displacement [m]", "displacement = displacement [mm]")),
      "prior_far_from_data");
  REQUIRE(smaller.size() == 1);
  CHECK(smaller[0].find("larger than the one measured") != std::string::npos);
}

TEST_CASE("a prior of both signs over decades too many is seen, though its middle is not far off") {
  std::string const text =
      with(with(shipped("duffing/duffing.sysid"), "log_uniform(1e3, 1e5)", "uniform(-1e9, 1e9)"), truth_task(), "");
  CheckResult const result = checked(models / "duffing/wide.sysid", text);
  auto const said = messages(result, "prior_far_from_data");
  REQUIRE(said.size() == 1);
  CHECK(said[0].find("% of the prior draws predict a range of displacement more than 100 times larger or smaller") !=
        std::string::npos);
  PriorPage::Channel const& channel = preflight(result, "posterior").prior->channels.at(0);
  CHECK(channel.middle / channel.measured < 100);
}

TEST_CASE("failed draws are counted as draws, once each, however many solves they fail in") {
  auto const sum = [](PriorPage const& page) {
    int all = page.untraced;
    for (Failure const& failure : page.failures) all += static_cast<int>(failure.count);
    return all;
  };
  PriorPage const two =
      *preflight(checked(models / "silverbox/two_stretches.sysid", shipped("silverbox/two_stretches.sysid")), "posterior").prior;
  CHECK(two.failed > 0);
  CHECK(sum(two) == two.failed);
  std::string const text =
      with(with(shipped("duffing/duffing.sysid"), "log_uniform(5e8, 5e10)", "uniform(-1e12, 1e11)"), truth_task(), "");
  CheckResult const result = checked(models / "duffing/softening.sysid", text);
  PriorPage const& many = *preflight(result, "posterior").prior;
  CHECK(many.failed > 8);
  CHECK(many.untraced == many.failed - 8);
  CHECK(sum(many) == many.failed);
  CHECK(check_text(result.page).find(std::to_string(many.failed) + " of 128 simulations fail") != std::string::npos);
}

TEST_CASE("of a large model less is looked at, and what is left out is said") {
  // A chain of 199 masses with a spring of its own each: 398 states, 202 parameters, 1000 samples.
  constexpr int masses = 199;
  TemporaryFolder folder;
  std::string table = "t,x,last\n", states, initial, springs, equations;
  for (int i = 0; i < 1000; ++i)
    table += std::to_string(0.01 * i) + "," + std::to_string(10 * std::sin(0.7 * i)) + "," +
             std::to_string(0.1 * std::sin(0.13 * i)) + "\n";
  write_file(folder.path() / "chain.csv", table);
  for (int i = 1; i <= masses; ++i) {
    std::string const n = std::to_string(i), q = "q" + n, comma = i == 1 ? "" : ", ";
    states += comma + q;
    initial += comma + q + " = 0, " + q + "' = 0";
    springs += "  parameter k" + n + " ~ log_uniform(1000, 10000)\n";
    equations += "  m*" + q + "'' + c*" + q + "' + k" + n + "*" + (i == 1 ? q : "(" + q + " - q" + std::to_string(i - 1) + ")");
    if (i < masses) equations += " - k" + std::to_string(i + 1) + "*(q" + std::to_string(i + 1) + " - " + q + ")";
    equations += i == masses ? " = x\n" : " = 0\n";
  }
  CheckResult const result =
      checked(folder.path() / "chain.sysid", "model chain {\n  input x\n  state " + states + "\n  initial " + initial +
                                                 "\n  parameter m ~ log_uniform(0.5, 2)\n  parameter c ~ log_uniform(0.1, 10)\n  "
                                                 "parameter sigma ~ log_uniform(1e-6, 1e-3)\n" +
                                                 springs + equations + "  observe last ~ normal(q199, sd = sigma)\n}\n" +
                                                 "data bench { file \"chain.csv\"; time t [s]; input x = x hold linear; measure "
                                                 "last = last }\nbest = fit chain to bench with map\n");
  PreflightPage const& page = preflight(result, "best");
  REQUIRE(page.prior);
  CHECK(page.prior->draws < 64);
  CHECK(page.prior->draws >= 16);
  CHECK_FALSE(page.information);
  CHECK(page.not_examined.find("derivatives with respect to 202 parameters would take too long for a model of this size") !=
        std::string::npos);
  CHECK(check_text(result.page).find("no errors or warnings in the parts that were checked") != std::string::npos);
}

TEST_CASE("a channel that is measured late is looked at where it is measured") {
  for (int const begin : {0, 10500}) {
    CAPTURE(begin);
    TemporaryFolder folder;
    std::string table = "t,x,y\n";
    double state = 0;
    for (int i = 0; i < 12000; ++i) {
      double const input = i / 50 % 2 == 0 ? 1 : -1;
      table += fmt::format("{},{},{}\n", 0.01 * i, input, i < begin ? "" : fmt::format("{:.6f}", state));
      state += 0.01 * (input - state);
    }
    write_file(folder.path() / "late.csv", table);
    CheckResult const result = checked(
        folder.path() / "late.sysid",
        "model lag { input x; state s; initial s = 0; parameter tau [s] ~ log_uniform(0.1, 10); tau*s' = x - s\n"
        "observe y ~ normal(s, sd = 0.1) }\n"
        "data late { file \"late.csv\"; time t [s]; input x = x hold linear; measure y = y }\nf = fit lag to late with map\n");
    PreflightPage const& page = preflight(result, "f");
    CHECK_MESSAGE(page.not_examined.empty(), page.not_examined);
    REQUIRE(page.information);
    CHECK(page.information->rows == (begin == 0 ? 10000 : 0));  // 0: all
  }
}

TEST_CASE("a prior that reaches where the model diverges is said with the term that does") {
  std::string const text =
      with(with(shipped("duffing/duffing.sysid"), "log_uniform(5e8, 5e10)", "uniform(-5e12, -5e11)"), truth_task(), "");
  CheckResult const result = checked(models / "duffing/softening.sysid", text);
  REQUIRE(messages(result, "prior_fails").size() == 1);
  CHECK(preflight(result, "posterior").prior->failures.front().where.find("y^3") != std::string::npos);
}

TEST_CASE("steps that the file states too coarse raise a warning with a number that would do") {
  std::string const text = with(shipped("silverbox/silverbox.sysid"), "thin = 4)", "thin = 4), substeps = 1");
  CheckResult const result = checked(models / "silverbox/coarse.sysid", text);
  REQUIRE(messages(result, "integration_step").size() == 1);
  InformationPage const& information = *preflight(result, "posterior").information;
  CHECK(information.moves.size() > 1);
  CHECK_FALSE(information.advised.empty());
  REQUIRE(information.found_move);
  CHECK(*information.found_move > tolerable_move);
}

TEST_CASE("steps that only draws of the prior find too coarse are no warning, and the page says what a mode does") {
  // The record is that of slower motion than most of the prior's, and one step a sample suffices for it.
  std::string const text = with(shipped("two_mass/two_mass.sysid"), "chains = 4), seed", "chains = 4), substeps = 1, seed");
  CheckResult const result = checked(models / "two_mass/stated.sysid", text);
  InformationPage const& information = *preflight(result, "posterior").information;
  REQUIRE_FALSE(information.moves.empty());
  CHECK(information.moves.front().second > tolerable_move);
  CHECK(messages(result, "integration_step").empty());
  REQUIRE(information.found_move);
  CHECK(*information.found_move <= tolerable_move);
  CHECK(check_text(result.page).find("the mode found with rk4(substeps = 1) from these draws changes by") != std::string::npos);
}

TEST_CASE("a prior that explicit steps cannot follow is called stiff, and the solver that follows it is named") {
  std::string const stated = shipped("robertson/robertson.sysid");
  std::string const explicit_steps = with(stated, "with map, solver = cvode(relative = 1e-6)", "with map, solver = rk4");
  REQUIRE(messages(checked(models / "robertson/explicit.sysid", explicit_steps), "stiff_prior").size() >= 1);
  CHECK(messages(checked(models / "robertson/explicit.sysid", explicit_steps), "stiff_prior")[0].find("cvode succeeds") !=
        std::string::npos);
  CHECK(messages(checked(models / "robertson/stated.sysid", stated), "stiff_prior").empty());
  CHECK(messages(checked(models / "duffing/duffing.sysid", shipped("duffing/duffing.sysid")), "stiff_prior").empty());
}

TEST_CASE("a solver for implicit equations is noted where they are explicit") {
  auto const with_solver = [](std::string const& solver) {
    std::string const text = with(shipped("duffing/duffing.sysid"), "rows 1..500, test", "rows 1..25, test");
    return checked(models / "duffing/solver.sysid", with(text, "chains = 4), seed", "chains = 4), solver = " + solver + ", seed"));
  };
  CHECK(messages(with_solver("ida"), "slower_solver").size() == 1);
  CHECK(messages(with_solver("cvode"), "slower_solver").empty());
  // A constraint is kept as it stands by ida alone.
  CheckResult const pendulum = checked(models / "pendulum/pendulum.sysid", shipped("pendulum/pendulum.sysid"));
  CHECK(messages(pendulum, "slower_solver").empty());
}

TEST_CASE("simulations that fail and those that are finite add up to the draws") {
  CheckResult const result =
      checked(models / "silverbox/silverbox.sysid", with(shipped("silverbox/silverbox.sysid"), "(rows = 50)", "(rows = 200)"));
  std::string const page = check_text(result.page);
  CHECK(page.find("all simulations are finite") == std::string::npos);
  CHECK(page.find("5 of 128 simulations fail with rk4(substeps = 1), 3 with dopri5, 3 with cvode: 2 fail only because "
                  "the steps are too long") != std::string::npos);
}

TEST_CASE("a solver with too few steps is advised more of them, and not itself") {
  CheckResult const result = checked(models / "duffing/spent.sysid", with(shipped("duffing/duffing.sysid"), "chains = 4), seed",
                                                                          "chains = 4), solver = dopri5(steps = 1), seed"));
  REQUIRE(messages(result, "integration_step").size() == 1);
  CHECK(messages(result, "integration_step")[0].find("need more steps between two samples") != std::string::npos);
  CHECK(messages(result, "stiff_prior").empty());
}

TEST_CASE("what is wrong with the data of several tasks is said at once, and the sound tasks are still looked at") {
  std::string const text = with(shipped("duffing/duffing.sysid"), "test = rows 501..1500", "test = rows 501..9500");
  CheckResult const result = checked(models / "duffing/rows.sysid", text);
  REQUIRE(result.diagnostics.all().size() == 1);
  CHECK(result.diagnostics.all().front().code == "E4016");
  CHECK_FALSE(result.unreadable);
  CHECK(preflight(result, "posterior").information);
  CHECK(task(result, "forecast").coverage.empty());
}

TEST_CASE("a range of one row is refused, and its step is not looked for") {
  std::filesystem::path const path =
      std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/errors/E4201_discovery_from_one_row.sysid";
  CheckResult const result = checked(path, read_file(path));
  REQUIRE_FALSE(result.diagnostics.all().empty());
  CHECK(result.diagnostics.all().front().code == "E4201");
}

TEST_CASE("data that a task of the file will make are said to be made by it") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  CheckResult const result = checked(folder.path() / "loop.sysid", bouc_wen, options);
  CHECK(result.diagnostics.all().empty());
  CHECK(task(result, "posterior").coverage.at(0).made_by == "truth");
  CHECK(task(result, "posterior").preflights.empty());
}

TEST_CASE("missing samples are counted per channel, and where the power of an input lies") {
  TemporaryFolder folder;
  std::string table = "t,u,y\n";
  for (int i = 0; i < 400; ++i) {
    // A sine of 5 Hz sampled at 100 Hz.
    double const t = i / 100.0, u = elementary::sin(2 * 3.14159265358979 * 5 * t);
    table += std::to_string(t) + "," + std::to_string(u) + "," + (i % 40 == 0 ? std::string() : std::to_string(0.5 * u)) + "\n";
  }
  write_file(folder.path() / "sine.csv", table);
  std::string const text = R"(
model lag { input u; state y; initial y = 0; parameter k ~ log_uniform(0.1, 1000); y' = k*(u - y); observe out ~ normal(y, sd = 0.1) }
data bench { file "sine.csv"; time t [s]; input u = u hold linear; measure out = y; split late = rows 101..400 }
posterior = fit lag to bench.late with map
)";
  CheckResult const result = checked(folder.path() / "lag.sysid", text);
  CoveragePage const& data = task(result, "posterior").coverage.at(0);
  CHECK(data.first == 101);
  CHECK(data.scored == 300);
  CHECK(data.channels.front().missing == 7);  // rows 121, 161, ..., 361
  CHECK(data.channels.front().measured == 293);
  CHECK(data.rate == doctest::Approx(100).epsilon(1e-9));
  // A record of T = 4 s spreads a sine: beyond B to one side lies 1/(2 pi^2 T B) of its power, 0.5 % from 2.5 Hz on.
  CHECK(data.inputs.front().low > 2);
  CHECK(data.inputs.front().low < 5);
  CHECK(data.inputs.front().high > 5);
  CHECK(data.inputs.front().high < 8);
}

TEST_CASE("the page for programs holds the messages, each as it is printed for a line") {
  Source const source("bad.sysid", "model m {\n  state y\n}\n");
  Diagnostics diagnostics;
  diagnostics.add({Severity::error, "E2001", "first", Label{{2, 5}, ""}, {}, "help"});
  diagnostics.add({Severity::warning, "E3019", "second", std::nullopt, {}, ""});
  CheckPage page;
  page.file = "bad.sysid";
  nlohmann::json const object = nlohmann::json::parse(check_json(page, render_json(diagnostics, source)));
  CHECK(object.at("file") == "bad.sysid");
  REQUIRE(object.at("messages").size() == 2);
  CHECK(object.at("messages").at(0) == nlohmann::json::parse(render_json(diagnostics.all()[0], source)));
  CHECK(object.at("messages").at(1).at("severity") == "warning");
  CHECK(object.at("tasks").empty());
}

TEST_CASE("check judges a solver by all prior draws, as the fit does, not by those that it follows") {
  // A fast state that the slow one leads: at most prior draws it overflows with any steps that a fit would try.
  std::string const fast =
      "model fastslow {\n input u [-]\n state a [-], b [-]\n initial a = 0, b = 0\n parameter eps [s] ~ log_uniform(1e-5, 0.1)\n"
      " parameter g [1/s] ~ log_uniform(0.05, 5)\n parameter c [-] ~ log_uniform(0.1, 10)\n eps*a' = b - a - c*a^3\n"
      " b' = -g*b + u*1 [1/s]\n observe out ~ normal(a, sd = 0.02)\n}\n"
      "data rec { file \"record.csv\"; time t [s]; input u = u hold zero_order; measure out = a }\n"
      "post = fit fastslow to rec with map, seed = 1\n";
  auto const check = [](std::string const& text) {
    std::string rows = "t,u,a\n";
    for (int row = 0; row < 250; ++row)
      rows += fmt::format("{:.6g},{},{:.6g}\n", 0.05 * row, row / 10 % 2 == 0 ? 1 : -1, 0.5 * elementary::sin(0.3 * row));
    TemporaryFolder folder;
    write_file(folder.path() / "record.csv", rows);
    return checked(folder.path() / "m.sysid", text);
  };
  CheckResult const result = check(fast);
  CHECK(messages(result, "stiff_prior").size() == 1);
  CHECK(check_text(result.page).find("is sufficient") == std::string::npos);
  CheckResult const cured = check(with(fast, "with map", "with map, solver = cvode"));
  CHECK(messages(cured, "stiff_prior").empty());
  CHECK(messages(cured, "prior_fails").empty());
}
