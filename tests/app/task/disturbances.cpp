// Fits of models with disturbances as a user runs them. The records are made here, with steps a hundred times as fine as the
// sampling, so that nothing of the program makes what it is tested with.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/disturbed/shaken_record.hpp"
#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::testing;
using json = nlohmann::json;

namespace {

bool was_found(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return true;
  return false;
}

std::string cure_of_filter(json const& summary) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == "linearisation_matters") return each.at("help");
  return {};
}

json check_record(json const& summary, std::string const& name) {
  for (json const& each : summary.at("checks"))
    if (each.at("name") == name) return each;
  return {};
}

/// x' = -a x^3 + w, white noise of intensity q, sampled at 4 Hz.
std::string sampled_well(double a, double q, std::uint64_t seed, double noise = 0.3) {
  Stream stream({seed, Purpose::test});
  constexpr int fine = 100;
  double const step = 0.25 / fine;
  double x = stream.normal();
  std::string text = "t,m\n";
  for (int i = 0; i < 200; ++i) {
    text += fmt::format("{},{}\n", 0.25 * i, x + noise * stream.normal());
    for (int k = 0; k < fine; ++k) x += -a * x * x * x * step + std::sqrt(q * step) * stream.normal();
  }
  return text;
}

std::string const well = R"(
model well {
  state x
  initial x ~ normal(0, sd = 1)
  parameter a [1/s] ~ log_uniform(0.1, 10)
  parameter q [1/s] ~ log_uniform(0.01, 10)
  disturbance w [1/s] ~ white(intensity = q)
  x' = -a*x^3 + w
  observe m ~ normal(x, sd = 0.3)
}
data d { file "d.csv"; time t [s]; measure m = m }
)";

std::string const shaken = R"(
model shaken {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(0.1, 10)
  parameter k [N/m] ~ log_uniform(40, 4000)
  parameter q [N^2 s] ~ log_uniform(1e-9, 1)
  disturbance w [N] ~ white(intensity = q)
  m*y'' + c*y' + k*y = x + w
  observe d [m] ~ normal(y, sd = 2e-5)
}
data bench { file "b.csv"; time t [s]; input x = x [N] hold zero_order; measure d = y [m]
  split train = rows 1..300, test = rows 301..600 }
)";

/// y_i = 0.8 y_i-1 + w, w of sd 0.5, measured with noise of sd 0.2 in every other row from 21 on.
std::vector<double> every_other(std::uint64_t seed) {
  Stream stream({seed, Purpose::test});
  std::vector<double> measured;
  double y = 0;
  for (int i = 0; i < 60; ++i) {
    if (i > 0) y = 0.8 * y + 0.5 * stream.normal();
    double const m = y + 0.2 * stream.normal();
    measured.push_back(i < 20 || i % 2 == 0 ? m : std::nan(""));
  }
  return measured;
}

struct Known {
  double mean, variance;
};
/// Row by row what is known of y from the rows `ahead` before it and earlier.
std::vector<Known> forecasts(std::vector<double> const& measured, std::size_t ahead) {
  auto const moved = [](Known const& y) { return Known{0.8 * y.mean, 0.64 * y.variance + 0.25}; };
  std::vector<Known> behind, out;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Known y = moved(i == 0 ? Known{0, 1} : behind.back());
    if (!std::isnan(measured[i])) {
      double const gain = y.variance / (y.variance + 0.04);
      y = {y.mean + gain * (measured[i] - y.mean), (1 - gain) * y.variance};
    }
    behind.push_back(y);
  }
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Known y = i < ahead ? Known{0, 1} : behind[i - ahead];  // the start is a row before the first one
    for (std::size_t k = 0; k < (i < ahead ? i + 1 : ahead); ++k) y = moved(y);
    out.push_back(y);
  }
  return out;
}

std::string const gappy = R"(
model level {
  time discrete 1 [s]
  state y
  initial y ~ normal(0, sd = 1)
  parameter a ~ normal(0.8, sd = 1e-9)
  disturbance w ~ normal(0, sd = 0.5)
  y = a*lag(y, 1) + w
  observe m ~ normal(y, sd = 0.2)
}
data d { file "d.csv"; time t [s]; measure m = m; split train = rows 1..20, test = rows 21..60 }
)";

std::string gappy_record(std::vector<double> const& measured) {
  std::string text = "t,m\n";
  for (std::size_t i = 0; i < measured.size(); ++i)
    text += std::isnan(measured[i]) ? fmt::format("{},\n", i) : fmt::format("{},{}\n", i, measured[i]);
  return text;
}

}  // namespace

TEST_CASE("a fit says where the linearisation of its filter decides the result, and only there") {
  std::string const extended = well + "post = fit well to d with map, seed = 1\n";
  CaseRun const strong(extended, {{"d.csv", sampled_well(1, 1, 3)}});
  CHECK(was_found(strong.summary("post"), "linearisation_matters"));
  std::string const unscented = well + "post = fit well to d with map, filter = unscented, seed = 1\n";
  CaseRun const mended(unscented, {{"d.csv", sampled_well(1, 1, 3)}});
  CHECK_FALSE(was_found(mended.summary("post"), "linearisation_matters"));
  // Within the spread of the states the cubic is a straight line.
  CaseRun const weak(with(extended, "normal(x, sd = 0.3)", "normal(x, sd = 0.003)"),
                     {{"d.csv", sampled_well(0.5, 0.02, 3, 0.003)}});
  CHECK_FALSE(was_found(weak.summary("post"), "linearisation_matters"));
}

// The sensor turns back where the state is low, and what is measured there says nothing of its sign.
TEST_CASE("particles find that no filter by mean and covariance suits a sensor that is bent within the spread of the state") {
  Stream stream({1, Purpose::test});
  std::string record = "t,m\n";
  double x = stream.normal();
  for (int i = 0; i < 60; ++i) {
    x = 0.8 * x + 0.6 * stream.normal();
    record += fmt::format("{},{}\n", i, x + 0.5 * x * x + 0.15 * stream.normal());
  }
  std::string const text = R"(
model bent {
  time discrete 1 [s]
  state x
  initial x ~ normal(0, sd = 1)
  parameter s ~ log_normal(median = 0.15, sd = 0.2)
  disturbance w ~ normal(0, sd = 0.6)
  x = 0.8*lag(x, 1) + w
  observe m ~ normal(x + 0.5*x^2, sd = s)
}
data d { file "d.csv"; time t [s]; measure m = m }
extended = fit bent to d with map, seed = 1
unscented = fit bent to d with map, filter = unscented, seed = 1
)";
  CaseRun const run(text, {{"d.csv", record}});
  for (char const* task : {"extended", "unscented"}) {
    CAPTURE(task);
    CHECK(was_found(run.summary(task), "linearisation_matters"));
    CHECK(cure_of_filter(run.summary(task)).starts_with("fit with `mh` and `filter = particle`"));
  }
}

// The gain of the noise has the mean 0, so that both filters see none of it.
TEST_CASE("particles find what a disturbance does that a random state multiplies") {
  Stream stream({1, Purpose::test});
  std::string record = "t,m\n";
  double v = stream.normal(), x = 0;
  for (int i = 0; i < 60; ++i) {
    double const before = v;
    v = 0.8 * v + 0.6 * stream.normal();
    x = 0.5 * x + before * stream.normal();
    record += fmt::format("{},{}\n", i, x + 0.3 * stream.normal());
  }
  std::string const text = R"(
model volatile {
  time discrete 1 [s]
  state v, x
  initial v ~ normal(0, sd = 1), x = 0
  parameter a ~ normal(0.5, sd = 0.1)
  disturbance p ~ normal(0, sd = 0.6)
  disturbance q ~ normal(0, sd = 1)
  v = 0.8*lag(v, 1) + p
  x = a*lag(x, 1) + lag(v, 1)*q
  observe m ~ normal(x, sd = 0.3)
}
data d { file "d.csv"; time t [s]; measure m = m }
post = fit volatile to d with map, filter = unscented, seed = 1
)";
  CaseRun const run(text, {{"d.csv", record}});
  CHECK(was_found(run.summary("post"), "linearisation_matters"));
}

TEST_CASE("particles agree with the filter of a spring that hardens a little, and are not asked where it is exact") {
  std::string const constants = with(without(shaken, "  parameter m [kg] ~ log_uniform(0.1, 10)\n"), "  m*y''", "  1 [kg]*y''");
  std::string const task = "post = fit shaken to bench.train with map, seed = 1\n";
  std::string const few = with(constants, "rows 1..300", "rows 1..60");
  CaseRun const hardening(with(few, "k*y = x", "k*y + 1e6 [N/m^3]*y^3 = x") + task, {{"b.csv", shaken_record(5, 0.05, 600, 1e6)}});
  CHECK(check_record(hardening.summary("post"), "against_particles").at("ran") == true);
  CHECK_FALSE(was_found(hardening.summary("post"), "linearisation_matters"));
  CaseRun const linear(few + task, {{"b.csv", shaken_record(5, 0.05, 600)}});
  CHECK(check_record(linear.summary("post"), "against_particles").is_null());
}

TEST_CASE("an unmeasured force is estimated, and without it the parameters are surer than they may be") {
  std::string const data = shaken_record(5, 0.05, 600);
  std::string const task = "post = fit shaken to bench.train with map, seed = 1\n";
  CaseRun const with_force(shaken + task, {{"b.csv", data}});
  json const summary = with_force.summary("post");
  CHECK_FALSE(was_found(summary, "residuals_not_white"));
  // 0.05 N held over 10 ms: an intensity of 0.05^2 * 0.01.
  double const q = parameter(summary, "q").at("mean"), sd = parameter(summary, "q").at("sd");
  CHECK(std::abs(q - 2.5e-5) < 3 * sd);
  CHECK(sd < 0.5e-5);
  std::string plain = with(shaken, " = x + w", " = x");
  plain = without(without(plain, "  disturbance w [N] ~ white(intensity = q)\n"), "  parameter q [N^2 s] ~ log_uniform(1e-9, 1)\n");
  CaseRun const sure(plain + task, {{"b.csv", data}});
  CHECK(was_found(sure.summary("post"), "residuals_not_white"));
  CHECK(sure.result.out.find("disturbance w ~ white(intensity = q)") != std::string::npos);
  CHECK(parameter(sure.summary("post"), "k").at("sd").get<double>() < 0.5 * parameter(summary, "k").at("sd").get<double>());
}

TEST_CASE("free predictions know the rows before them and widen; one step ahead they know each row before") {
  std::string const text =
      shaken +
      "post = fit shaken to bench.train with mh(samples = 2000, burn_in = 1000, thin = 10, chains = 4), seed = 1\n"
      "free = predict post on bench.test with draws(100), seed = 1\n"
      "step = predict post on bench.test with draws(100), prediction = one_step, seed = 1\n"
      "first = predict post on bench.test with draws(100), prediction = steps(1), seed = 1\n"
      "third = predict post on bench.test with draws(100), prediction = steps(3), seed = 1\n"
      "all = predict post on bench.test with draws(100), prediction = steps(300), seed = 1\n";
  CaseRun const run(text, {{"b.csv", shaken_record(5, 0.05, 600)}});
  auto const score = [&](std::string const& task, std::string const& name) {
    return run.summary(task).at("fit").at(name).get<double>();
  };
  CHECK(score("step", "rmse") < 0.5 * score("free", "rmse"));
  CHECK(score("free", "coverage_95") > 0.9);
  CHECK(score("step", "coverage_95") > 0.9);
  auto const rule = [&](std::string const& task) { return run.summary(task).at("settings").at("prediction").get<std::string>(); };
  CHECK(rule("step") == "one_step: states estimated from all samples before each row");
  CHECK(rule("free") == "free_run: states estimated only from the samples before the first predicted row");
  CHECK(run.summary("step").at("prediction_rule") == "one_step");
  // Between both: three rows ahead. One row is the same as one step.
  CHECK(score("first", "rmse") == score("step", "rmse"));
  CHECK(score("third", "rmse") > score("step", "rmse"));
  CHECK(score("third", "rmse") < score("free", "rmse"));
  CHECK(score("third", "coverage_95") > 0.9);
  CHECK(score("all", "coverage_95") > 0.9);
  CHECK(rule("third") == "steps(3): states estimated from the samples at least 3 rows before each row");
  CHECK(run.summary("third").at("prediction_rule") == "3 steps");
  // The last row of the free run is known from the rows before the predicted ones, as it is 300 rows ahead.
  auto const last = [&](std::string const& task) {
    std::string const table = run.file(task + "/predict.csv");
    return table.substr(table.rfind('\n', table.size() - 2) + 1);
  };
  CHECK(last("all") == last("free"));
  CHECK(run.summary("free").at("prediction_rule") == "free_run");
}

TEST_CASE("a prediction has the errors that inputs have in its own data, not those of the fit") {
  std::string plain = with(shaken, " = x + w", " = x");
  plain = without(without(plain, "  disturbance w [N] ~ white(intensity = q)\n"), "  parameter q [N^2 s] ~ log_uniform(1e-9, 1)\n");
  std::string const text =
      plain +
      "data noisy { file \"b.csv\"; time t [s]; input x = x [N] hold zero_order error normal(sd = 0.3); measure d = y [m]\n"
      "  split test = rows 301..600 }\n"
      "post = fit shaken to bench.train with map, seed = 1\n"
      "exact = predict post on bench.test with draws(50), seed = 1\n"
      "open = predict post on noisy.test with draws(50), seed = 1\n"
      "step = predict post on noisy.test with draws(50), prediction = one_step, seed = 1\n";
  CaseRun const run(text, {{"b.csv", shaken_record(5, 0, 600)}});
  CHECK_FALSE(run.summary("exact").at("settings").contains("prediction"));
  CHECK(run.summary("open").at("settings").at("prediction").get<std::string>().starts_with("free_run: "));
  CHECK(run.summary("step").at("settings").at("prediction").get<std::string>().starts_with("one_step: "));
}

TEST_CASE("a simulation draws its disturbances") {
  std::string const text = with(shaken, "observe d [m] ~ normal(y, sd = 2e-5)", "observe d [m] ~ normal(y, sd = 1e-9)") +
                           "made = simulate shaken with values(m = 1, c = 1, k = 400, q = 1e-4), input x = sine(amplitude = 0, "
                           "frequency = 1 [Hz]), samples = 4000, rate = 100 [Hz], substeps = 4, seed = 4, file = \"made.csv\"\n";
  CaseRun const run(text, {{"b.csv", shaken_record(5, 0, 600)}});
  // The stationary sd of the displacement of a white force: sqrt(q/(2 c k)).
  std::istringstream lines(run.file("made/made.csv"));
  double sum = 0, count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || !(std::isdigit(static_cast<unsigned char>(line[0])) != 0)) continue;
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 3; ++i) std::getline(cells, cell, ',');
    if (++count <= 500) continue;  // what has not yet been shaken long enough
    sum += std::stod(cell) * std::stod(cell);
  }
  CHECK(std::sqrt(sum / (count - 500)) == relative(std::sqrt(1e-4 / (2 * 1 * 400)), 0.15));
}

TEST_CASE("in discrete time every sample corrects the states behind it, also where the one before is missing") {
  // The equation reads the state of the row before, not its sample.
  std::vector<double> const measured = every_other(3);
  std::string const text = gappy +
                           "post = fit level to d.train with map, seed = 1\n"
                           "step = predict post on d.test with prediction = one_step, seed = 1\n"
                           "third = predict post on d.test with prediction = steps(3), seed = 1\n";
  CaseRun const run(text, {{"d.csv", gappy_record(measured)}});
  for (auto const& [task, ahead] : {std::pair("step", 1), std::pair("third", 3)}) {
    CAPTURE(task);
    std::vector<Known> const known = forecasts(measured, static_cast<std::size_t>(ahead));
    std::vector<double> const mean = column(run.file(fmt::format("{}/predict.csv", task)), "m_mean"),
                              sd = column(run.file(fmt::format("{}/predict.csv", task)), "m_sd");
    REQUIRE(mean.size() >= 40);
    for (std::size_t k = 1; k <= 40; ++k) {
      CHECK(mean[mean.size() - k] == relative(known[60 - k].mean, 1e-6));
      CHECK(sd[sd.size() - k] == doctest::Approx(std::sqrt(known[60 - k].variance)).epsilon(1e-6));
    }
    CHECK(run.summary(task).at("data").dump().find("a past sample is missing") == std::string::npos);
  }
}

TEST_CASE("particles predict as many rows ahead as is asked for") {
  std::vector<double> const measured = every_other(3);
  std::string text = with(gappy, "normal(y, sd = 0.2)", "student_t(y, 1e4, scale = 0.2)");
  text +=
      "post = fit level to d.train with mh(samples = 400, burn_in = 200, chains = 2), particles = 1000, seed = 1\n"
      "step = predict post on d.test with draws(50), prediction = one_step, seed = 1\n"
      "third = predict post on d.test with draws(50), prediction = steps(3), seed = 1\n"
      "all = predict post on d.test with draws(50), prediction = steps(100), seed = 1\n";
  CaseRun const run(text, {{"d.csv", gappy_record(measured)}});
  for (auto const& [task, ahead] : {std::pair("step", 1), std::pair("third", 3), std::pair("all", 100)}) {
    CAPTURE(task);
    std::vector<Known> const known = forecasts(measured, static_cast<std::size_t>(ahead));
    std::vector<double> const mean = column(run.file(fmt::format("{}/predict.csv", task)), "m_mean"),
                              sd = column(run.file(fmt::format("{}/predict.csv", task)), "m_sd");
    REQUIRE(mean.size() >= 40);
    // 50 runs of 1000 particles: a mean is off by 0.004 sds or so.
    for (std::size_t k = 1; k <= 40; ++k) {
      double const exact = std::sqrt(known[60 - k].variance);
      CHECK(std::abs(mean[mean.size() - k] - known[60 - k].mean) < 0.03 * exact);
      CHECK(sd[sd.size() - k] == doctest::Approx(exact).epsilon(0.03));
    }
  }
}
