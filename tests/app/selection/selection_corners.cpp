// Selections whose answer is known beforehand, or that have no good one: two units of one model, priors over decades, models
// without parameters, budgets, channels without samples.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/selection/line.hpp"
#include "app/tables.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;
using testing::Line;
using testing::Printed;
using testing::slope;

namespace {

std::string const metres =
    "model a { input u [s]; parameter k [m/s] ~ uniform(0, 10); parameter c [m] ~ uniform(-5, 5)\n"
    "observe d [m] ~ normal(k*u + c, sd = 0.1) }\n";
std::string const millimetres =
    "model b { input u [s]; parameter k [mm/s] ~ uniform(0, 10000); parameter c [mm] ~ uniform(-5000, 5000)\n"
    "observe d [mm] ~ normal(k*u + c, sd = 0.1 [m]) }\n";

}  // namespace

TEST_CASE("a model in metres and the same one in millimetres are equally probable, and predict one band") {
  Line const line(0.1, 0.5);
  for (std::string const distance : {"", ", distance = rmse", ", distance = abs(residual(d))"}) {
    CAPTURE(distance);
    Printed const answer =
        line.run(metres + millimetres + "candidates both { a; b }\nanswer = select both to line with abc_smc(particles = 500)" +
                     distance + ", seed = 1\nforecast = predict answer on line with draws(100), seed = 1",
                 "[m]", {"select", "predict"});
    // Of two equal models a population holds each with its share of 500 draws: four standard errors.
    CHECK(std::abs(answer.model("a").at("probability").get<double>() - 0.5) < 4 * 0.5 / std::sqrt(500.0));
    CHECK(answer.model("a").at("laplace").at("probability").get<double>() == doctest::Approx(0.5).epsilon(1e-3));
    CHECK_FALSE(answer.has("probabilities_disagree"));
    // The unit of the most probable model; the line ends at 0.5 + 2 * 3.9 m.
    std::istringstream rows(read_file(line.results() / "forecast/predict.csv"));
    std::string row, last;
    while (std::getline(rows, row))
      if (!row.empty()) last = row;
    double const unit = answer.model("a").at("probability") > answer.model("b").at("probability") ? 1 : 1000;
    int columns = 0;
    std::istringstream cells(last);
    for (std::string cell; std::getline(cells, cell, ',');) {
      double const value = std::atof(cell.c_str());
      if (value > 5 * unit && value < 12 * unit) ++columns;
    }
    CHECK(columns >= 4);  // mean, two bounds and the sample
  }
}

TEST_CASE("a model in degrees Celsius and the same one in kelvin are alike by a distance of absolute values, and in one band") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u [s]; parameter k [K/s] ~ uniform(0, 10); parameter c [degC] ~ uniform(-5, 5)\n"
      "observe d [degC] ~ normal(k*u + c, sd = 0.1) }\n"
      "model b { input u [s]; parameter k [K/s] ~ uniform(0, 10); parameter c [K] ~ uniform(268.15, 278.15)\n"
      "observe d [K] ~ normal(k*u + c, sd = 0.1) }\n"
      "candidates both { a; b }\nanswer = select both to line with abc_smc(particles = 500), "
      "distance = (residual(d)/(measured(d) + 20))^2, seed = 1\nforecast = predict answer on line with draws(100), seed = 1",
      "[degC]", {"select", "predict"});
  CHECK(std::abs(answer.model("a").at("probability").get<double>() - 0.5) < 0.3);
  std::string const csv = read_file(line.results() / "forecast/predict.csv");
  double const zero = column(csv, "d_mean").back() > 100 ? 273.15 : 0;  // of the unit of the model that leads
  for (char const* const bound : {"d_q2.5", "d_mean", "d_q97.5"})       // the line ends at 0.5 + 2 * 3.9
    CHECK(std::abs(column(csv, bound).back() - zero - 8.3) < 3);
}

TEST_CASE("models whose names differ in Greek letters alone have draws of their own, from which they are predicted") {
  Line const line(0.1, 0.5);
  auto const model = [](std::string const& name, std::string const& mean) {
    return "model " + name + " { input u; parameter k ~ uniform(0, 4); observe d ~ normal(" + mean + ", sd = 0.1) }\n";
  };
  std::string const text = model("line_\u03b1", "k*u + 0.45") + model("line_\u03b2", "k*u + 0.55") +
                           "candidates both { line_\u03b1; line_\u03b2 }\n"
                           "answer = select both to line with abc_smc(particles = 200), seed = 1\n"
                           "forecast = predict answer on line with draws(100), seed = 1";
  line.run(text, "", {"select", "predict"});
  std::filesystem::path const predicted = line.results() / "forecast/predict.csv";
  std::string const at_once = read_file(predicted);
  for (char const* name : {"particles_line_.csv", "particles_line__.csv"})
    CHECK_MESSAGE(std::filesystem::exists(line.results() / "answer" / name), name);
  CHECK(read_file(line.results() / "answer/particles_line_.csv") != read_file(line.results() / "answer/particles_line__.csv"));
  line.run(text, "", {"predict"});
  CHECK(read_file(predicted) == at_once);
}

TEST_CASE("channels of two units and two noises make one root mean square") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      "model a { input u [s]; parameter k [m/s] ~ uniform(0, 10); parameter g [m/s] ~ uniform(0, 10)\n"
      "observe d [m] ~ normal(k*u, sd = 0.1)\n observe e [mm] ~ normal(g*u, sd = 0.3 [m]) }\n"
      "data two { file \"line.csv\"; time t [s]; input u = t [s] hold linear; measure d = y [m]; measure e = y [m] }\n"
      "answer = select a to two with abc_smc(particles = 300), distance = rmse, weights(d = 3, e = 1), seed = 1",
      "[m]");
  // Both are the same line, so both slopes are known alike; the floor of the mean of two root mean squares is (3*0.1 + 0.3)/4 m.
  json const& parameters = answer.model("a").at("parameters");
  for (char const* name : {"k", "g"}) CHECK(parameters.at(name).at("mean").get<double>() == doctest::Approx(slope).epsilon(0.05));
  CHECK(answer.summary.at("populations").at("noise_floor").get<double>() == relative(0.15, 1e-12));
}

TEST_CASE("a prior over six decades does not kill its model") {
  // d = k u, exact data: p(M | D) goes as the prior density at k = 2. normal(0, 1) above 0: 2 phi(2) = 0.10798; half_normal(1) the
  // same; log_uniform(1e-3, 1e3): 1/(2 log 1e6) = 0.03619. The third has 0.03619 / (2 * 0.10798 + 0.03619) = 0.1435.
  Line const line(0, 0);
  std::string text;
  for (auto const& [name, prior] :
       {std::pair{"a", "normal(0, sd = 1, lower = 0)"}, {"b", "half_normal(1)"}, {"c", "log_uniform(0.001, 1000)"}})
    text += std::string("model ") + name + " { input u; parameter k ~ " + prior + "\nobserve d ~ normal(k*u, sd = 0.1) }\n";
  text += "candidates all { a; b; c }\n";
  double mean = 0;
  int const seeds = 5;
  for (int seed = 1; seed <= seeds; ++seed) {
    Printed const answer = line.run(
        text + "answer = select all to line with abc_smc(particles = 1000, populations = 6), seed = " + std::to_string(seed));
    CHECK(answer.model("c").at("died_in_population").is_null());
    CHECK(answer.model("c").at("laplace").at("probability").get<double>() == relative(0.1435, 0.02));
    mean += answer.model("c").at("probability").get<double>() / seeds;
  }
  // A third of 1000 particles is proposed to each model: standard error of a weight sum about 0.1435 sqrt(2/333) a run.
  CHECK(std::abs(mean - 0.1435) < 4 * 0.1435 * std::sqrt(2.0 / 333 / seeds));
}

TEST_CASE("a model that chance never proposed is not told dead by distance") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "model b { input u; parameter k ~ uniform(0, 10); parameter c ~ uniform(0, 1); observe d ~ normal(k*u + c, sd = 0.1) }\n"
      "candidates both { a probability 0.9999; b probability 0.0001 }\n"
      "answer = select both to line with abc_smc(particles = 100), seed = 1");
  REQUIRE(answer.model("b").at("died_in_population") == 1);
  CHECK(answer.model("b").at("died_by_chance") == true);
  CHECK(answer.has("model_lost_by_chance"));
  CHECK(answer.model("b").at("laplace").at("probability").get<double>() > 0.9);
  CHECK(answer.has("probabilities_disagree"));
}

TEST_CASE("a model whose draws all diverge is named, and is not said to have a likelihood") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      "model lin { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "model boom { input u; state q; initial q = 1; parameter growth ~ uniform(1e6, 1e7); parameter b ~ uniform(-2, -1)\n"
      "q' = growth*q^2; observe d ~ normal(q + b*u, sd = 0.1) }\ncandidates s { lin; boom }\n"
      "answer = select s to line with abc_smc(particles = 200), seed = 1");
  CHECK(answer.model("boom").at("died_by_chance") == false);
  CHECK_FALSE(answer.model("boom").contains("laplace"));
  CHECK(answer.out.find("of the priors of `boom` did not stay finite") != std::string::npos);
  // The first failures are traced to a place and a time; of the others nobody knows the time, and nobody reads a number for it.
  json const& failures = answer.summary.at("ledger").at("failures");
  int traced = 0, untold = 0;
  for (json const& failure : failures) (failure.at("time").is_null() ? untold : traced) += failure.at("count").get<int>();
  CHECK(traced == 8);
  // Examples have the names and values of the model that failed, not of the one that leads.
  for (json const& failure : failures) {
    json const& example = failure.at("example");
    REQUIRE(example.size() == 2);
    CHECK(example.at("growth").get<double>() > 1e6);
    CHECK(example.at("growth").get<double>() < 1e7);
    CHECK(example.at("b").get<double>() < -1);
    CHECK(example.at("b").get<double>() > -2);
  }
  CHECK(untold > 8);
  CHECK(answer.out.find("nan") == std::string::npos);
  CHECK(read_file(line.results() / "answer/report.html").find("nan") == std::string::npos);
}

TEST_CASE("distances beyond the range of numbers are failed simulations: they set no threshold") {
  // The mean of |r| 1e306 over 40 rows leaves the range for slopes above about 4.3, more than half of the prior.
  Line const line(0.0, 0.0);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "answer = select a to line with abc_smc(particles = 200, populations = 5), distance = 1e306*abs(residual(d)), seed = 1");
  CHECK(answer.has("failed_solves"));
  CHECK(answer.summary.at("populations").at("count") == 5);
  double const threshold = answer.summary.at("populations").at("threshold").get<double>();
  CHECK(threshold < 1e306);
  // |k - 2| mean(u) 1e306 within the threshold, mean(u) = 1.95: a uniform density about 2 with an sd of a 1/sqrt(3) of that.
  json const& k = answer.model("a").at("parameters").at("k");
  double const width = threshold / 1.95e306;
  CHECK(std::abs(k.at("mean").get<double>() - 2) < width);
  CHECK(k.at("sd").get<double>() == relative(width / std::sqrt(3.0), 0.2));
}

TEST_CASE("a distance that is zero at every draw is said to tell nothing") {
  Line const line(0.0, 0.0);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "answer = select a to line with abc_smc(particles = 200), distance = max(abs(residual(d)) - 1000, 0), seed = 1");
  CHECK(answer.has("distances_equal"));
}

TEST_CASE("a model that fits exactly brings the threshold to zero, and the figure and the report bear it") {
  Line const line(0.0, 0.0);
  Printed const answer = line.run(
      "model a { input u; parameter k = 2; observe d ~ normal(k*u, sd = 0.1) }\n"
      "model b { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "candidates both { a; b }\nanswer = select both to line with abc_smc(particles = 200), seed = 1");
  CHECK(answer.summary.at("populations").at("threshold") == 0);
  CHECK(answer.model("a").at("probability") == 1);
  CHECK(answer.model("b").at("died_in_population").get<int>() == 2);
  std::string const figure = read_file(line.results() / "answer/figures/populations.gnuplot");
  CHECK(figure.find("$threshold") != std::string::npos);
  CHECK(figure.find("inf") == std::string::npos);
}

TEST_CASE("the noise floor is that of the model that needs the least noise, whichever leads") {
  // Stopped early, a constant leads: it has more of its prior within reach. It takes the slope for noise; the floor must not.
  Line const line(0.1, 0.0);
  auto const run = [&](std::string const& noise, std::string const& sd) {
    return line.run(
        "model constant { input u; parameter c ~ uniform(0, 8);" + noise + "; observe d ~ normal(c + 0*u, sd = " + sd +
        ") }\nmodel sloped { input u; parameter c ~ uniform(-100, 100); parameter k ~ uniform(-50, 50);" + noise +
        "; observe d ~ normal(c + k*u, sd = " + sd +
        ") }\ncandidates both { constant; sloped }\nanswer = select both to line with abc_smc(particles = 300, target = "
        "200), seed = 1");
  };
  // y = 2 t over 40 rows of 0.1: population variance 4 * 0.01 * (40^2 - 1)/12, plus the noise's.
  double const floor = 100 * 0.01 / (0.04 * 1599 / 12 + 0.01);
  Printed const open = run("parameter sigma ~ log_uniform(0.001, 100)", "sigma");
  REQUIRE(open.model("constant").at("probability").get<double>() > 0.5);
  // The variance of 40 samples' noise is known to sqrt(2/40).
  double const found = open.summary.at("populations").at("noise_floor").get<double>();
  CHECK(found == relative(floor, 3 * std::sqrt(2.0 / 40)));
  CHECK(open.has("threshold_above_noise"));
  Printed const stated = run("parameter g ~ uniform(0, 1); derive h = g", "0.1");
  REQUIRE(stated.model("constant").at("probability").get<double>() > 0.5);
  CHECK(stated.summary.at("populations").at("noise_floor").get<double>() == relative(floor, 0.05));
}

TEST_CASE("a shared parameter that only the noise reads is listed with its prior and the reason") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); parameter sigma ~ log_uniform(0.01, 0.5); observe d ~ normal(k*u, sd = "
      "sigma) "
      "}\nmodel b { input u; parameter k ~ uniform(0, 10); parameter c ~ uniform(0, 1); parameter sigma ~ log_uniform(0.01, 0.5)\n"
      "observe d ~ normal(k*u + c, sd = sigma) }\ncandidates both { a; b; shared k, sigma }\n"
      "answer = select both to line with abc_smc(particles = 200), seed = 1");
  json const& shared = answer.summary.at("populations").at("shared");
  CHECK(shared.at("k").contains("sd"));
  CHECK(shared.at("sigma").at("prior") == "log_uniform(0.01, 0.5)");
  CHECK(shared.at("sigma").at("because").get<std::string>().find("only the noise uses it") != std::string::npos);
  CHECK(answer.out.find("log_uniform(0.01, 0.5)") != std::string::npos);
}

TEST_CASE("elements of a shared vector that every experiment has for itself are summarised for each") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u; parameter c(2) per experiment ~ uniform(0, 10); observe d ~ normal(c[1]*u + 0.05*c[2], sd = 0.5) }\n"
      "model b { input u; parameter c(2) per experiment ~ uniform(0, 10); parameter g ~ uniform(0, 1)\n"
      "observe d ~ normal(c[1]*u + 0.05*c[2] + g, sd = 0.5) }\ncandidates both { a; b; shared c }\n"
      "answer = select both to line with abc_smc(particles = 200), seed = 1");
  json const& shared = answer.summary.at("populations").at("shared");
  CHECK(shared.at("c[1,line]").contains("sd"));
  CHECK(shared.at("c[2,line]").contains("sd"));
  CHECK(answer.out.find("only the noise uses it") == std::string::npos);
}

TEST_CASE("a shared value that is fixed in all models has no prior to stay at, and is not listed") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); parameter g = 2; observe d ~ normal(k*u*g/2, sd = 0.5) }\n"
      "model b { input u; parameter k ~ uniform(0, 10); parameter c ~ uniform(0, 1); parameter g = 2\n"
      "observe d ~ normal(k*u*g/2 + c, sd = 0.5) }\ncandidates both { a; b; shared k, g }\n"
      "answer = select both to line with abc_smc(particles = 200), seed = 1");
  json const& shared = answer.summary.at("populations").at("shared");
  CHECK(shared.at("k").contains("sd"));
  CHECK_FALSE(shared.contains("g"));
}

TEST_CASE("a derived quantity that reads the noise is left out, and said") {
  Line const line(0.1, 0.5);
  Printed const answer = line.run(
      "model a { input u; parameter k ~ uniform(0, 10); parameter c ~ uniform(0, 1); parameter sigma ~ log_uniform(0.01, 0.5)\n"
      "observe d ~ normal(k*u + c, sd = sigma); derive e = k*u/sigma; derive g = 2*k*u }\n"
      "answer = select a to line with abc_smc(particles = 200), seed = 1");
  CHECK(answer.has("reads_noise"));
  std::string const bands = read_file(line.results() / "answer/predict.csv");
  CHECK(bands.find("g_mean") != std::string::npos);
  CHECK(bands.find("e_mean") == std::string::npos);
}

TEST_CASE("a candidate without free parameters takes part from end to end") {
  Line const line(0.1, 0.0);
  Printed const answer = line.run(
      "model a { input u; parameter k = 2; observe d ~ normal(k*u, sd = 0.1) }\n"
      "model b { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1) }\n"
      "candidates both { a; b }\nanswer = select both to line with abc_smc(particles = 200), seed = 1");
  CHECK(answer.model("a").at("probability").get<double>() > 0.9);
  CHECK(answer.model("a").at("laplace").at("probability").get<double>() > 0.9);
}

TEST_CASE("proposals outside of the priors and rates that cannot be reached end a run") {
  Line const line(0.1, 0.0);
  std::string const model =
      "model a { input u; parameter k ~ uniform(0, 10); parameter c ~ uniform(-1, 1); observe d ~ normal(k*u + c, sd = 0.1) }\n";
  Printed const wide =
      line.run(model +
               "answer = select a to line with abc_smc(particles = 200, kernel_scale = 1e9, coordinates = declared, "
               "simulations = 2000), seed = 1");
  CHECK(wide.has("budget_spent"));
  Printed const rate = line.run(model + "answer = select a to line with abc_smc(particles = 200, acceptance = 0.3), seed = 1");
  CHECK(rate.summary.at("populations").at("stopped_by").get<std::string>().find("0.3") != std::string::npos);
}

TEST_CASE("what no setting reads, and a weight that no sample carries, are refused") {
  Line const line(0.1, 0.0);
  std::string const model =
      "model a { input u; parameter k ~ uniform(0, 10); observe d ~ normal(k*u, sd = 0.1)\n"
      "observe w ~ normal(k*u, sd = 0.1) }\n";
  auto const code = [&](std::string const& task) {
    try {
      line.run(model +
               "data two { file \"line.csv\"; time t [s]; input u = t [-] hold linear; measure d = y; measure w = none }\n" + task);
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
    return std::string("none");
  };
  CHECK(code("answer = select a to line with abc_smc(schedule = (10, 1), target = 5), seed = 1") == "E6203");
  // 0 stands for the default; what is so small or so large moves nothing, or everything out of the prior.
  CHECK(code("answer = select a to line with abc_smc(kernel_scale = 1e-320), seed = 1") == "E6005");
  CHECK(code("answer = select a to line with abc_smc(kernel_scale = 1e300), seed = 1") == "E6005");
  CHECK(code("answer = select a to line with abc_smc(particles = 50, populations = 2, kernel_scale = 0), seed = 1") == "none");
  CHECK(code("answer = select a to line with abc_smc(neighbours = 7), seed = 1") == "E6203");
  CHECK(code("answer = select a to line with abc_smc(stay = 0.1), seed = 1") == "E6203");
  CHECK(code("answer = select a to two with abc_smc(particles = 50), weights(w = 3, d = 1), seed = 1") == "E6517");
}

TEST_CASE("without a cross-check nothing is said by likelihood, and with one the solver is named that it is said with") {
  Line const line(0.1, 0.5);
  std::string const text =
      "model a { input u; state q; initial q = 0.5; parameter k ~ uniform(0, 10); q' = k; observe d ~ normal(q, sd = 0.1) }\n"
      "answer = select a to line with abc_smc(particles = 200";
  Printed const unchecked = line.run(text + ", cross_check = no), seed = 1");
  CHECK_FALSE(unchecked.model("a").contains("laplace"));
  CHECK(unchecked.model("a").at("probability") == 1);
  // A straight line is exact in one step; nothing finer is taken.
  Printed const checked = line.run(text + "), seed = 1");
  CHECK(checked.model("a").at("laplace").at("solver") == "rk4(substeps = 1)");
  CHECK_FALSE(checked.has("integration_step"));
}

TEST_CASE("a step that shapes the likelihood is made finer for it, and one that puts the particles off is named") {
  // q'' = -w^2 q from 0 to 3.9 s in steps of 0.1 s: at w = 20 a step turns by 2 rad, far from what RK4 can follow.
  Line const line(0.1, 0.0);
  std::string const model =
      "model a { input u; state q, v; initial q = 0, v = 0; parameter k ~ uniform(0, 10); parameter w ~ uniform(15, 25)\n"
      "q' = v; v' = w^2*(k*u - q); observe d ~ normal(q, sd = 0.1) }\n"
      "answer = select a to line with abc_smc(particles = 200)";
  Printed const settled = line.run(model + ", seed = 1");
  CHECK(settled.model("a").at("laplace").at("solver") != "rk4(substeps = 1)");
  CHECK(settled.has("integration_step"));
  Printed const stated = line.run(model + ", substeps = 1, seed = 1");
  CHECK(stated.model("a").at("laplace").at("solver") == "rk4(substeps = 1)");
  CHECK(stated.has("integration_step"));
  Printed const fine = line.run(model + ", substeps = 32, seed = 1");
  CHECK_FALSE(fine.has("integration_step"));
}
