// Linear-Gaussian models on several experiments: shared, own and hierarchical parameters against closed forms and quadrature.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "fits.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

// Means within 3 MCSE, sds within 5 %, at an effective sample size of 2000.
void check(Fitted const& fitted, std::string const& name, double mean, double sd) {
  INFO(name);
  auto const& found = fitted.of("posterior", name);
  CHECK(found.at("ess_bulk").get<double>() >= 2000);
  CHECK(std::abs(found.at("mean").get<double>() - mean) <= 3 * found.at("mcse_mean").get<double>());
  CHECK(found.at("sd").get<double>() == relative(sd, 0.05));
}

// A posterior of linear regression: precision and information, prior first.
struct Gaussian {
  Eigen::MatrixXd precision;
  Eigen::VectorXd information;
  void add(Eigen::VectorXd const& regressor, double y, double sd) {
    precision += regressor * regressor.transpose() / (sd * sd);
    information += regressor * (y / (sd * sd));
  }
  Eigen::VectorXd mean() const { return solve_symmetric(precision, information); }
  double sd(int i) const { return std::sqrt(inverse(precision)(i, i)); }
};

}  // namespace

TEST_CASE("two experiments with shared slope and own intercepts have the closed-form posterior") {
  // y' = b x with x held, level = y + a: rows of regressors (b, a of the first, a of the second).
  Gaussian exact{Eigen::MatrixXd::Identity(3, 3) / 4, Eigen::VectorXd::Zero(3)};
  std::map<std::string, std::string> files;
  Stream stream({21, Purpose::test, 0, 0});
  double const truth[] = {0.8, -1.0, 2.5}, noise[] = {0.3, 0.6}, step[] = {0.1, 0.25};
  int const rows[] = {50, 30};
  for (int e = 0; e < 2; ++e) {
    std::string csv = "t,x,y\n";
    double slope = 0;
    for (int i = 0; i < rows[e]; ++i) {
      double const x = stream.normal(), y = truth[0] * slope + truth[1 + e] + noise[e] * stream.normal();
      csv += shortest(i * step[e]) + "," + shortest(x) + "," + shortest(y) + "\n";
      Eigen::VectorXd regressor = Eigen::VectorXd::Zero(3);
      regressor(0) = slope;
      regressor(1 + e) = 1;
      exact.add(regressor, y, noise[e]);
      slope += step[e] * x;
    }
    files[e == 0 ? "one.csv" : "two.csv"] = csv;
  }
  std::string const text = R"(
model line {
  input x
  state y
  initial y = 0
  parameter b ~ normal(0, sd = 2)
  parameter a per experiment ~ normal(0, sd = 2)
  parameter noise per experiment
  y' = b*x
  observe level ~ normal(y + a, sd = noise)
  derive total = a + b
}
data one { file "one.csv"; time t [s]; input x = x hold zero_order; measure level = y; constant noise = 0.3 }
data two { file "two.csv"; time t [s]; input x = x hold zero_order; measure level = y; constant noise = 0.6 }
posterior = fit line to one, two with mh(samples = 30000, burn_in = 5000, thin = 5), seed = 1
)";
  Fitted const fitted = run_file(text, {}, files);
  CHECK(fitted.exit == 0);
  Eigen::VectorXd const mean = exact.mean();
  check(fitted, "b", mean(0), exact.sd(0));
  check(fitted, "a[one]", mean(1), exact.sd(1));
  check(fitted, "a[two]", mean(2), exact.sd(2));
  // The sum of b and the first intercept: variance of a linear form.
  Eigen::Vector3d const form(1, 1, 0);
  check(fitted, "total[one]", form.dot(mean), std::sqrt(form.dot(inverse(exact.precision) * form)));
  CHECK(!fitted.summary.at("posterior").at("parameters").contains("noise[one]"));
}

namespace {

// Four groups of a few samples around their own level, which is the initial value of a state that stays.
struct Groups {
  std::map<std::string, std::string> files;
  std::vector<double> mean;  // of each group
  std::vector<int> rows = {3, 5, 8, 4};
  double noise = 0.5;

  Groups() {
    Stream stream({22, Purpose::test, 0, 0});
    double const level[] = {1.2, 2.9, 2.0, 3.4};
    for (std::size_t g = 0; g < rows.size(); ++g) {
      std::string csv = "t,x,y\n";
      mean.push_back(0);
      for (int i = 0; i < rows[g]; ++i) {
        double const y = level[g] + noise * stream.normal();
        csv += shortest(i) + ",0," + shortest(y) + "\n";
        mean.back() += y / rows[g];
      }
      files["group" + std::to_string(g + 1) + ".csv"] = csv;
    }
  }
  double variance(std::size_t g) const { return noise * noise / rows[g]; }

  std::string text(std::string const& spread, std::string const& settings) const {
    std::string out = "model groups {\n  input x\n  state y\n  initial y = level\n  parameter mu ~ normal(0, sd = 3)\n";
    out += "  parameter tau " + spread + "\n  parameter level per experiment ~ normal(mu, sd = tau)\n  y' = x\n";
    out += "  observe value ~ normal(y, sd = 0.5)\n}\n";
    std::string names;
    for (std::size_t g = 1; g <= rows.size(); ++g) {
      std::string const name = "group" + std::to_string(g);
      out += "data " + name + " { file \"" + name + ".csv\"; time t [s]; input x = x hold zero_order; measure value = y }\n";
      names += (g == 1 ? "" : ", ") + name;
    }
    return out + "posterior = fit groups to " + names + " with mh(" + settings + "), seed = 3\n";
  }
};

}  // namespace

TEST_CASE("a hierarchy with known spread has the normal-normal posterior, shrunken towards the population's mean") {
  Groups const groups;
  double const tau = 0.8;
  // Unknowns: mu, then the levels.
  Gaussian exact{Eigen::MatrixXd::Zero(5, 5), Eigen::VectorXd::Zero(5)};
  exact.precision(0, 0) = 1 / 9.0;
  for (int g = 0; g < 4; ++g) {
    Eigen::VectorXd link = Eigen::VectorXd::Zero(5);
    link(0) = -1;
    link(1 + g) = 1;
    exact.add(link, 0, tau);
    Eigen::VectorXd own = Eigen::VectorXd::Zero(5);
    own(1 + g) = 1;
    exact.add(own, groups.mean[static_cast<std::size_t>(g)], std::sqrt(groups.variance(static_cast<std::size_t>(g))));
  }
  Fitted const fitted = run_file(groups.text("= 0.8", "samples = 40000, burn_in = 5000, thin = 5"), {}, groups.files);
  CHECK(fitted.exit == 0);
  Eigen::VectorXd const mean = exact.mean();
  check(fitted, "mu", mean(0), exact.sd(0));
  for (int g = 0; g < 4; ++g) check(fitted, "level[group" + std::to_string(g + 1) + "]", mean(1 + g), exact.sd(1 + g));
}

namespace {

// Moments of mu, tau and the levels of a normal hierarchy with known variances of the groups' means: given tau all is normal in
// closed form, tau by the midpoint rule.
struct Quadrature {
  double mass = 0;
  std::vector<double> mean, square;  // of mu, tau, then the levels

  template <class LogPrior>
  Quadrature(std::vector<double> const& y, std::vector<double> const& variance, double prior_sd, LogPrior const& log_prior,
             double most, double h)
      : mean(y.size() + 2, 0.0), square(mean) {
    for (double tau = 0.5 * h; tau < most; tau += h) {
      double precision = 1 / (prior_sd * prior_sd), information = 0, squares = 0, log_density = log_prior(tau);
      for (std::size_t g = 0; g < y.size(); ++g) {
        double const v = tau * tau + variance[g];
        precision += 1 / v;
        information += y[g] / v;
        squares += y[g] * y[g] / v;
        log_density -= 0.5 * std::log(v);
      }
      double const centre = information / precision;
      log_density += -0.5 * std::log(precision) - 0.5 * (squares - information * centre);
      double const weight = std::exp(log_density) * h;
      mass += weight;
      add(0, weight, centre, 1 / precision);
      add(1, weight, tau, 0);
      for (std::size_t g = 0; g < y.size(); ++g) {
        double const own = 1 / variance[g] + 1 / (tau * tau), pull = 1 / (tau * tau) / own;
        add(2 + g, weight, y[g] / variance[g] / own + pull * centre, 1 / own + pull * pull / precision);
      }
    }
  }
  double mean_of(std::size_t i) const { return mean[i] / mass; }
  double sd_of(std::size_t i) const { return std::sqrt(square[i] / mass - mean_of(i) * mean_of(i)); }

 private:
  void add(std::size_t i, double weight, double m, double v) {
    mean[i] += weight * m;
    square[i] += weight * (m * m + v);
  }
};

}  // namespace

TEST_CASE("mean and spread of a population agree with quadrature over the spread") {
  Groups const groups;
  std::vector<double> variance;
  for (std::size_t g = 0; g < groups.rows.size(); ++g) variance.push_back(groups.variance(g));
  Quadrature const exact(
      groups.mean, variance, 3, [](double tau) { return -0.5 * tau * tau / 4; }, 12, 1e-3);
  Fitted const fitted = run_file(groups.text("~ half_normal(2)", "samples = 120000, burn_in = 20000, thin = 10"), {}, groups.files);
  CHECK(fitted.exit == 0);
  check(fitted, "mu", exact.mean_of(0), exact.sd_of(0));
  check(fitted, "tau", exact.mean_of(1), exact.sd_of(1));
  check(fitted, "level[group2]", exact.mean_of(3), exact.sd_of(3));
  CHECK(fitted.of("posterior", "tau").at("rhat").get<double>() < 1.01);
}

namespace {

// Rubin 1981, table 1: effects of coaching in eight schools and their standard errors.
std::vector<double> const effects = {28, 8, -3, 7, -1, 1, 18, 12}, standard_errors = {15, 10, 16, 11, 9, 11, 10, 18};

Fitted schools(std::vector<double> const& effects, std::vector<double> const& standard_errors, std::string const& population,
               std::string const& members, std::string const& task) {
  std::string text = "model schools {\n  input x\n  state y\n  initial y = effect\n  parameter error per experiment\n" +
                     population + members + "  y' = x\n  observe result ~ normal(y, sd = error)\n}\n";
  std::map<std::string, std::string> files;
  std::string names;
  for (std::size_t s = 0; s < effects.size(); ++s) {
    std::string const name(1, static_cast<char>('A' + s));
    files[name + ".csv"] = "t,x,y\n0,0," + shortest(effects[s]) + "\n1,0,NA\n";
    text +=
        "data " + name + " { file \"" + name +
        ".csv\"; time t [s]; input x = x hold zero_order; measure result = y; constant error = " + shortest(standard_errors[s]) +
        " }\n";
    names += (names.empty() ? "" : ", ") + name;
  }
  return run_file(text + "posterior = fit schools to " + names + " with " + task + ", seed = 1\n", {}, files);
}

Fitted eight_schools(std::string const& members, std::string const& task) {
  return schools(effects, standard_errors, "  parameter mu ~ normal(0, sd = 5)\n  parameter tau ~ half_cauchy(scale = 5)\n",
                 members, task);
}

std::string const chains = "mh(samples = 120000, burn_in = 20000, thin = 20)";

}  // namespace

TEST_CASE("the eight schools by standardised members agree with quadrature") {
  std::vector<double> variance;
  for (double const e : standard_errors) variance.push_back(e * e);
  // The half-Cauchy tail beyond 1000 is cut by a likelihood that falls as tau^-7.
  Quadrature const exact(
      effects, variance, 5, [](double tau) { return -std::log1p(tau * tau / 25); }, 1000, 2e-3);
  Fitted const fitted = eight_schools("  parameter z per experiment ~ normal(0, sd = 1)\n  derive effect = mu + tau*z\n", chains);
  CHECK(fitted.exit == 0);
  check(fitted, "mu", exact.mean_of(0), exact.sd_of(0));
  check(fitted, "tau", exact.mean_of(1), exact.sd_of(1));
  for (std::size_t s = 0; s < 8; ++s)
    check(fitted, "effect[" + std::string(1, static_cast<char>('A' + s)) + "]", exact.mean_of(2 + s), exact.sd_of(2 + s));
  CHECK_FALSE(fitted.found("posterior", "hierarchy_narrows"));
  // Moves along ridges are tried, and given up: with them to the end there were 95 million simulations.
  CHECK(fitted.summary.at("posterior").at("ledger").at("solves").get<double>() < 6e6);
}

// The prior of the spread is thirty times as wide as the spread: where members and population together are most probable, the data
// seem to know each member far better than the population does.
TEST_CASE("members that differ little are sampled given their population, under a wide prior of its spread") {
  std::vector<double> const values = {8.2, 7.1, 9.4, 6.6, 8.8, 7.5, 8.0, 7.9}, errors(8, 1.0), variance(8, 1.0);
  Quadrature const exact(
      values, variance, 20, [](double tau) { return -0.5 * tau * tau / 400; }, 100, 1e-3);
  for (std::string const task : {"mh", "nuts"}) DOCTEST_SUBCASE(task.c_str()) {
      Fitted const fitted = schools(values, errors, "  parameter mu ~ normal(0, sd = 20)\n  parameter tau ~ half_normal(20)\n",
                                    "  parameter effect per experiment ~ normal(mu, sd = tau)\n", task);
      CHECK(fitted.exit == 0);
      CHECK(fitted.summary.at("posterior").at("settings").at("non_centred") == "effect");
      check(fitted, "mu", exact.mean_of(0), exact.sd_of(0));
      check(fitted, "tau", exact.mean_of(1), exact.sd_of(1));
    }
}

TEST_CASE("members of which the data know the sum alone are sampled as declared") {
  Stream stream({23, Purpose::test, 0, 0});
  std::string csv = "t,x,y\n";
  double held = 0;
  for (int i = 0; i < 100; ++i) {
    double const x = stream.normal();
    csv += shortest(0.1 * i) + "," + shortest(x) + "," + shortest(40 * held + 0.01 * stream.normal()) + "\n";
    held += 0.1 * x;
  }
  Fitted const fitted = run_file(
      "model m {\n  input x\n  state y\n  initial y = 0\n  parameter mu ~ normal(10, sd = 10)\n  parameter tau ~ half_normal(5)\n"
      "  parameter k(4) ~ normal(mu, sd = tau)\n  y' = x*sum(k)\n  observe level ~ normal(y, sd = 0.01)\n}\n"
      "data d { file \"d.csv\"; time t [s]; input x = x hold zero_order; measure level = y }\n"
      "posterior = fit m to d with mh(samples = 2000, burn_in = 500), seed = 1\n",
      {}, {{"d.csv", csv}});
  CHECK_FALSE(fitted.summary.at("posterior").at("settings").contains("non_centred"));
}

TEST_CASE("the eight schools as they stand agree with quadrature") {
  std::vector<double> variance;
  for (double const e : standard_errors) variance.push_back(e * e);
  Quadrature const exact(
      effects, variance, 5, [](double tau) { return -std::log1p(tau * tau / 25); }, 1000, 2e-3);
  for (std::string const task : {"mh", "nuts", "tempering", "auto"}) DOCTEST_SUBCASE(task.c_str()) {
      Fitted const fitted = eight_schools("  parameter effect per experiment ~ normal(mu, sd = tau)\n", task);
      CHECK(fitted.exit == 0);
      auto const& settings = fitted.summary.at("posterior").at("settings");
      CHECK(settings.at("non_centred") == "effect");
      CHECK(settings.at("backend") == (task == "auto" ? "mh" : task));
      CHECK(settings.contains("chosen_because") == (task == "auto"));
      check(fitted, "mu", exact.mean_of(0), exact.sd_of(0));
      check(fitted, "tau", exact.mean_of(1), exact.sd_of(1));
      CHECK(fitted.of("posterior", "tau").at("rhat").get<double>() < 1.01);
      for (std::size_t s = 0; s < 8; ++s)
        check(fitted, "effect[" + std::string(1, static_cast<char>('A' + s)) + "]", exact.mean_of(2 + s), exact.sd_of(2 + s));
      CHECK_FALSE(fitted.found("posterior", "trajectories_diverge"));
    }
}

TEST_CASE("the eight schools with truncated members are refused, with the way out; their optimum comes with a warning") {
  std::string const members = "  parameter effect per experiment ~ normal(mu, sd = tau, lower = -1000)\n";
  Fitted const fitted = eight_schools(members, "mh(samples = 6000, burn_in = 2000)");
  CHECK(fitted.exit == 1);
  bool const refused = fitted.found("posterior", "chains_disagree") || fitted.found("posterior", "chains_not_quite_agreed") ||
                       fitted.found("posterior", "chain_did_not_move");
  CHECK(refused);
  CHECK(fitted.found("posterior", "hierarchy_narrows"));
  CHECK(eight_schools(members, "map").found("posterior", "optimum_of_hierarchy"));
}
