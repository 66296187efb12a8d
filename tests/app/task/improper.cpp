// Fits under improper priors: against closed forms, from any scale, refused where the posterior is improper, without an evidence.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/answer.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

struct Sampled {
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
  std::string csv = "u,w,y\n";

  Sampled(int rows, std::function<double(double u, double w, Stream&)> const& response) : x(rows, 2), y(rows) {
    Stream stream({.seed = 11, .purpose = Purpose::test, .index = 0, .step = 0});
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < rows; ++i) {
      double const u = -3 + 6.0 * i / (rows - 1), w = stream.uniform();
      x(i, 0) = 1, x(i, 1) = u, y(i) = response(u, w, stream);
      text << u << "," << w << "," << y(i) << "\n";
    }
    csv += text.str();
  }
};

Sampled line_of(int rows) {
  return {rows, [](double u, double, Stream& stream) { return -2 + 1.5 * u + 0.3 * stream.normal(); }};
}

std::string text_of(std::string const& parameters, std::string const& mean, std::string const& fit) {
  return "model line {\n  input u, w\n" + parameters + "  observe y [m] ~ normal(" + mean +
         ", sd = sigma)\n}\ndata d { file \"d.csv\"; input u = u; input w = w; measure y = y [m] }\nposterior = fit line to d "
         "with " +
         fit + ", seed = 1\n";
}

std::string const coefficients = "  parameter a [m] ~ flat()\n  parameter b [m] ~ flat()\n";
std::string const sigma = "  parameter sigma [m] ~ log_flat()\n";

/// The message of a fit that ends without a result; empty where it has one.
Diagnostic refused(std::string const& parameters, std::string const& mean, Sampled const& record, std::string const& fit = "mh") {
  try {
    CaseRun const run(text_of(parameters, mean, fit), {{"d.csv", record.csv}});
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  return {};
}

bool warned(json const& summary, std::string const& code) { return summary.at("findings").dump().find(code) != std::string::npos; }

double value(json const& of, char const* key) { return of.at(key).get<double>(); }

}  // namespace

TEST_CASE("a regression with flat coefficients and a log_flat sd has the posterior of the closed form") {
  constexpr int rows = 12;
  Sampled const record = line_of(rows);
  Eigen::MatrixXd const inverse_squares = inverse(Eigen::MatrixXd(record.x.transpose() * record.x));
  Eigen::VectorXd const estimate = inverse_squares * (record.x.transpose() * record.y);
  double const rest = (record.y - record.x * estimate).squaredNorm();
  constexpr double freedom = rows - 2;
  // sigma^2 = rest / chi-square of `freedom`; coefficients Student's t of `freedom`.
  double const mean_sigma = std::sqrt(rest / 2) * std::exp(std::lgamma((freedom - 1) / 2) - std::lgamma(freedom / 2));
  double const sd_sigma = std::sqrt(rest / (freedom - 2) - mean_sigma * mean_sigma);
  for (std::string const fit : {"mh", "nuts", "tempering", "auto"}) {
    CAPTURE(fit);
    CaseRun const run(text_of(coefficients + sigma, "a + b*u", fit), {{"d.csv", record.csv}});
    json const summary = run.summary("posterior");
    CHECK_FALSE(warned(summary, "propriety_not_checked"));
    auto const check = [&](std::string const& name, double mean, double sd) {
      CAPTURE(name);
      json const found = parameter(summary, name);
      double const draws = value(found, "ess_bulk");
      CHECK(std::fabs(value(found, "mean") - mean) < 4 * sd / std::sqrt(draws));
      // The sd of t10 and of 1/sqrt(chi-square of 10) varies by less than three times what that of a normal does.
      CHECK(std::fabs(value(found, "sd") / sd - 1) < 4 * 1.75 / std::sqrt(2 * std::min(draws, value(found, "ess_tail"))));
    };
    for (int p = 0; p < 2; ++p) check(p == 0 ? "a" : "b", estimate(p), std::sqrt(rest / (freedom - 2) * inverse_squares(p, p)));
    check("sigma", mean_sigma, sd_sigma);
  }
  CaseRun const run(text_of(coefficients + sigma, "a + b*u", "map"), {{"d.csv", record.csv}});
  json const summary = run.summary("posterior");
  CHECK(value(parameter(summary, "a"), "mean") == doctest::Approx(estimate(0)).epsilon(1e-4));
  CHECK(value(parameter(summary, "b"), "mean") == doctest::Approx(estimate(1)).epsilon(1e-4));
  // The density is proportional to sigma^-(rows + 1) exp(-rest / 2 sigma^2).
  CHECK(value(parameter(summary, "sigma"), "mean") == doctest::Approx(std::sqrt(rest / (rows + 1))).epsilon(1e-4));
}

TEST_CASE("draws of tempering keep the densities of the posterior, not of its reference") {
  Sampled const record = line_of(12);
  CaseRun const run(text_of(coefficients + sigma, "a + b*u", "tempering(samples = 600, burn_in = 300)"), {{"d.csv", record.csv}});
  std::istringstream draws(run.file("posterior/draws_1.csv"));
  std::string header, first;
  while (std::getline(draws, header) && header.starts_with('#')) {
  }
  std::getline(draws, first);
  std::map<std::string, double> at;
  std::istringstream names(header), values(first);
  for (std::string name, number; std::getline(names, name, ',') && std::getline(values, number, ',');) at[name] = std::stod(number);
  CHECK(at.at("log_prior__") == doctest::Approx(-std::log(at.at("sigma"))).epsilon(1e-6));
  double log_likelihood = 0;
  for (int i = 0; i < record.y.size(); ++i) {
    double const z = (record.y(i) - at.at("a") - at.at("b") * record.x(i, 1)) / at.at("sigma");
    log_likelihood -= 0.5 * z * z + std::log(at.at("sigma")) + 0.5 * std::log(2 * std::numbers::pi);
  }
  CHECK(at.at("log_likelihood__") == doctest::Approx(log_likelihood).epsilon(1e-6));
}

TEST_CASE("parameters are found whatever their size") {
  Sampled const record = line_of(20);
  CaseRun const run(text_of("  parameter a [m] ~ flat()\n  parameter b [m] ~ flat(lower = 0)\n" + sigma, "1e6*a + 1e-9*b*u", "map"),
                    {{"d.csv", record.csv}});
  json const summary = run.summary("posterior");
  CHECK(value(parameter(summary, "a"), "mean") == relative(-2e-6, 0.2));
  CHECK(value(parameter(summary, "b"), "mean") == doctest::Approx(1.5e9).epsilon(0.2));
}

TEST_CASE("an improper posterior is refused with the parameter that the data do not bound") {
  Sampled const record = line_of(30);
  auto const check = [&](std::string const& parameters, std::string const& mean, std::string const& named, Sampled const& of) {
    for (std::string const fit : {"map", "mh"}) {
      CAPTURE(mean);
      CAPTURE(fit);
      Diagnostic const found = refused(parameters, mean, of, fit);
      CAPTURE(found.message);
      CHECK(found.code == "E6211");
      CHECK(found.message.find(named) != std::string::npos);
    }
  };
  // The likelihood does not depend on c.
  check(coefficients + "  parameter c ~ flat()\n" + sigma, "a + b*u + 0*c*u", "`c`", record);
  // A product; a ratio.
  check(coefficients + "  parameter c ~ flat()\n" + sigma, "a + b*c*u", "c", record);
  check(coefficients + "  parameter c ~ flat(lower = 0)\n" + sigma, "a + b/c*u", "c", record);
  // Saturated nowhere: only b/c is known.
  check(coefficients + "  parameter c ~ flat(lower = 0)\n" + sigma, "a + b*tanh(u/c)", "c", record);
  // Two regressors that are one.
  check(coefficients + "  parameter c [m] ~ flat()\n" + sigma, "a + b*u + c*u", "c", record);
  // The residuals can be zero: as many parameters as rows, and more.
  Sampled const two = line_of(2);
  check(coefficients + sigma, "a + b*u", "residuals zero", two);
  // By the residuals, or by what the sd drags along, as the mode is told to the last digit or not.
  check(coefficients + "  parameter c [m] ~ flat()\n" + sigma, "a + b*u + c*w", "", two);
  // One row more, but an sd whose prior leaves it a tail of no freedom.
  check(coefficients + "  parameter sigma [m] ~ flat(lower = 0)\n", "a + b*u", "", line_of(3));
}

TEST_CASE("friction that is not there leaves its speed without bounds, and friction that is there does not") {
  std::string const parameters =
      "  parameter a [m] ~ flat()\n  parameter b [m] ~ flat()\n  parameter v ~ flat(lower = 0)\n" + sigma;
  auto const record = [](double size) {
    return Sampled(
        60, [size](double u, double, Stream& stream) { return 0.7 * u + size * std::tanh(u / 0.4) + 0.1 * stream.normal(); });
  };
  CHECK(refused(parameters, "a*u + b*tanh(u/v)", record(0)).code == "E6211");
  CHECK(refused(with(parameters, "flat(lower = 0)", "log_flat()"), "a*u + b*tanh(u/v)", record(0)).code == "E6211");
  CaseRun const run(text_of(parameters, "a*u + b*tanh(u/v)", "mh"), {{"d.csv", record(2).csv}});
  json const summary = run.summary("posterior");
  CHECK(std::fabs(value(parameter(summary, "v"), "mean") - 0.4) < 4 * value(parameter(summary, "v"), "sd"));
  CHECK_FALSE(warned(summary, "propriety_not_checked"));
}

TEST_CASE("the spread of a population is refused under log_flat, and under flat where members are too few") {
  auto const text = [](int members, std::string const& spread) {
    std::string out = "model level {\n  parameter mu ~ flat()\n  parameter tau ~ " + spread +
                      "\n  parameter theta per experiment ~ normal(mu, sd = tau)\n  parameter sigma ~ log_flat()\n"
                      "  observe y ~ normal(theta, sd = sigma)\n}\n";
    std::string all;
    for (int k = 0; k < members; ++k) {
      std::string const name = "g" + std::to_string(k);
      out += "data " + name + " { file \"" + name + ".csv\"; measure y = y }\n";
      all += (k == 0 ? "" : ", ") + name;
    }
    return out + "posterior = fit level to " + all + " with mh(samples = 400, burn_in = 200, thin = 1), seed = 1\n";
  };
  std::vector<std::pair<std::string, std::string>> files;
  Stream stream({.seed = 12, .purpose = Purpose::test, .index = 0, .step = 0});
  for (int k = 0; k < 6; ++k) {
    std::string csv = "y\n";
    double const level = 10 + 2 * stream.normal();
    for (int i = 0; i < 6; ++i) csv += std::to_string(level + stream.normal()) + "\n";
    files.emplace_back("g" + std::to_string(k) + ".csv", csv);
  }
  auto const code = [&](int members, std::string const& spread) {
    try {
      CaseRun const run(text(members, spread), files);
    } catch (UnusableData const& error) {
      return error.diagnostics().all().front().code;
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
    return std::string();
  };
  CHECK(code(6, "log_flat()") == "E6204");
  CHECK(code(2, "flat(lower = 0)") == "E6211");
  CHECK(code(6, "flat(lower = 0)") == "");
}

TEST_CASE("a fit under improper priors has no evidence, and says why") {
  Sampled const record = line_of(12);
  for (std::string const fit : {"map", "mh(samples = 400, burn_in = 200, thin = 1)"}) {
    CaseRun const run(text_of(coefficients + sigma, "a + b*u", fit), {{"d.csv", record.csv}});
    json const summary = run.summary("posterior");
    CHECK(summary.at("evidence").at("log_evidence").is_null());
    CHECK(summary.at("evidence").at("reason").get<std::string>().find("the prior of `a` is improper (flat)") != std::string::npos);
    CHECK_FALSE(summary.contains("prior_widths"));
  }
  CHECK_THROWS_AS(CaseRun(text_of(coefficients + sigma, "a + b*u", "mh, evidence = smc"), {{"d.csv", record.csv}}), UnusableData);
}

TEST_CASE("a coefficient under log_flat is found where the data put it, not at the pole of its prior") {
  Sampled const record = line_of(30);
  std::string const parameters = "  parameter a [m] ~ flat()\n  parameter b [m] ~ log_flat()\n" + sigma;
  for (std::string const fit : {"ml", "map", "mh"}) {
    CAPTURE(fit);
    CaseRun const run(text_of(parameters, "a + b*u", fit), {{"d.csv", record.csv}});
    CHECK(value(parameter(run.summary("posterior"), "b"), "mean") == doctest::Approx(1.5).epsilon(0.1));
  }
}

TEST_CASE("an offset that is large against the noise is no sign of residuals that are zero") {
  for (double const offset : {1e6, 4e9}) {
    CAPTURE(offset);
    Sampled const record(30, [&](double u, double, Stream& stream) { return offset + 0.1 * u + 0.1 * stream.normal(); });
    CaseRun const run(text_of(coefficients + sigma, "a + b*u", "map"), {{"d.csv", record.csv}});
    CHECK(value(parameter(run.summary("posterior"), "sigma"), "mean") == relative(0.1, 0.4));
  }
}

TEST_CASE("a phase without bounds repeats itself and is refused") {
  Sampled const record(60, [](double u, double, Stream& stream) { return 2 * std::sin(1.3 * u + 0.4) + 0.1 * stream.normal(); });
  for (std::string const amplitude : {"flat()", "flat(lower = 0)"}) {
    CAPTURE(amplitude);
    Diagnostic const found =
        refused("  parameter A [m] ~ " + amplitude + "\n  parameter p ~ flat()\n" + sigma, "A*sin(1.3*u + p)", record);
    CHECK(found.code == "E6211");
    CHECK(found.message.find("`p`") != std::string::npos);
    CHECK(refused("  parameter A [m] ~ " + amplitude + "\n  parameter p ~ uniform(-1.5, 1.5)\n" + sigma, "A*sin(1.3*u + p)", record)
              .code == "");
  }
}

TEST_CASE("what makes the spread of a population vanish is refused whatever its name and prior, but not by a fit without priors") {
  Sampled const record = line_of(30);
  auto const code = [&](std::string const& spread, std::string const& scale, std::string const& mean, std::string const& fit) {
    try {
      CaseRun const run(text_of("  parameter a [m] ~ flat()\n  parameter t " + spread +
                                    "\n  parameter b [m] ~ normal(0, sd = " + scale + ")\n" + sigma,
                                mean, fit),
                        {{"d.csv", record.csv}});
    } catch (UnusableData const& error) {
      return error.diagnostics().all().front().code;
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
    return std::string();
  };
  CHECK(code("[m] ~ log_flat()", "t", "a + b*u", "mh") == "E6204");
  CHECK(code("[m] ~ log_flat()", "t", "a + b*u + 1e-30*t", "mh") == "E6204");
  CHECK(code("~ flat()", "exp(t)*1 [m]", "a + b*u", "mh") == "E6204");
  CHECK(code("[1/m] ~ flat(lower = 0)", "1/t", "a + b*u", "mh") == "E6204");
  CHECK(code("[m] ~ log_flat()", "t", "a + b*u", "ml") == "");
}
