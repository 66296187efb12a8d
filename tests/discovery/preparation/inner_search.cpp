// Parameters inside terms: found with the terms, fitted with the coefficients, and in the model that is written.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// Rosenzweig and MacArthur 1963 with half saturation 0.6, by Runge and Kutta's method at twenty steps a sample.
std::string grazing(std::uint64_t seed, double noise) {
  std::array<double, 2> at = {1.0, 0.5};
  auto const rate = [](std::array<double, 2> const& s) {
    double const eaten = s[0] * s[1] / (0.6 + s[0]);
    return std::array{s[0] - s[0] * s[0] / 3 - 1.5 * eaten, 0.9 * eaten - 0.4 * s[1]};
  };
  auto const moved = [](std::array<double, 2> const& s, std::array<double, 2> const& by, double step) {
    return std::array{s[0] + step * by[0], s[1] + step * by[1]};
  };
  Stream random({seed, Purpose::noise, 0, 0});
  std::string csv = "t,x,y\n";
  for (int i = 0; i < 200; ++i) {
    csv += fmt::format("{:.10g},{:.12g},{:.12g}\n", 0.2 * i, at[0] + noise * 0.8 * random.normal(),
                       at[1] + noise * 0.5 * random.normal());
    for (int k = 0; k < 20; ++k) {
      double const h = 0.01;
      auto const a = rate(at), b = rate(moved(at, a, h / 2)), c = rate(moved(at, b, h / 2)), d = rate(moved(at, c, h));
      for (std::size_t j = 0; j < 2; ++j) at[j] += h / 6 * (a[j] + 2 * b[j] + 2 * c[j] + d[j]);
    }
  }
  return csv;
}

struct Found {
  json summary;
  std::string source, out;

  Found(std::string const& csv, std::string const& dictionary, std::string const& measured, std::string const& options) {
    TemporaryFolder folder;
    write_file(folder.path() / "made.csv", csv);
    RunOptions run;
    run.output = folder.path() / "results";
    RunResult const result = run_text(folder.path() / "made.sysid",
                                      "dictionary made {\n" + dictionary + "}\ndata record { file \"made.csv\"\n" + measured +
                                          "}\nfound = discover made from record with " + options + "seed = 1\n",
                                      run);
    out = result.out;
    summary = json::parse(read_file(folder.path() / "results/found/summary.json"));
    source = read_file(folder.path() / "results/found/found.sysid");
  }

  json const& first() const { return summary.at("discovery").at("judged").at("structures").at(0); }
  json coefficient(std::string const& target, std::string const& term) const {
    for (json const& each : first().at("coefficients"))
      if (each.at("target") == target && each.at("term") == term) return each;
    return {};
  }
};

std::string const terms =
    "state x = x, y = y\nparameter K ~ log_uniform(0.05, 20)\ntarget = x', y'\nterms = polynomial(x, y, degree = 2), 1, x*y/(K + "
    "x)\n";
std::string const columns = "time t [s]; measure x = x; measure y = y\n";

}  // namespace

TEST_CASE("the half saturation of a predator is found with the form, and known as well as its sd says") {
  int exact = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Found const found(grazing(seed, 0.01), terms, columns, "");
    exact += found.first().at("terms") == "x': x, x^2, x*y/(K + x); y': y, x*y/(K + x)" ? 1 : 0;
    json const inside = found.coefficient("", "K");
    REQUIRE(!inside.is_null());
    CHECK(inside.at("inside_terms") == true);
    double const value = inside.at("value"), sd = inside.at("sd");
    MESSAGE("half saturation ", value, " with an sd of ", sd);
    CHECK(sd < 0.01);
    CHECK(std::abs(value - 0.6) < 3 * sd);
    double const saturated = found.coefficient("x'", "x*y/(K + x)").at("value");
    CHECK(saturated == doctest::Approx(-1.5).epsilon(0.03).scale(0));
    CHECK(found.source.find("parameter K") != std::string::npos);
    CHECK(found.source.find("~ log_uniform(0.05, 20)") != std::string::npos);
    CHECK(found.summary.at("discovery").at("inside_terms").at(0).at("name") == "K");
  }
  CHECK(exact == 3);
}

TEST_CASE("without noise it is known to nine digits, and no term is there that the values of the search had needed") {
  Found const found(grazing(1, 0), terms, columns, "");
  CHECK(found.first().at("terms") == "x': x, x^2, x*y/(K + x); y': y, x*y/(K + x)");
  CHECK(std::abs(found.coefficient("", "K").at("value").get<double>() - 0.6) < 1e-8);
}

TEST_CASE("by the regression alone, of a difference equation, where the record is explained best") {
  Stream input({3, Purpose::input, 0, 0}), noise({3, Purpose::noise, 0, 0});
  std::string csv = "u,y\n";
  std::vector<double> us, ys;
  double y = 0;
  for (int i = 0; i < 600; ++i) {
    double const u = std::abs(input.normal());
    csv += fmt::format("{:.15g},{:.15g}\n", u, y);
    us.push_back(u);
    ys.push_back(y);
    y = 0.7 * y + 2 * u / (0.5 + u) + 0.02 * noise.normal();
  }
  Found const found(csv,
                    "time discrete\ninput u\nstate y = y\nparameter K ~ uniform(0.01, 3)\ntarget = y\n"
                    "terms = lag(y, 1), lag(u, 1), lag(u, 1)^2, lag(y, 1)^2, 1, lag(u, 1)/(K + lag(u, 1))\n",
                    "step 1 [s]; input u = u; measure y = y\n", "spike_slab, ");
  json const& equation = found.summary.at("discovery").at("equations").at(0);
  std::vector<std::string> kept;
  for (json const& term : equation.at("terms"))
    if (term.at("kept").get<bool>()) kept.push_back(term.at("term"));
  CHECK(kept == std::vector<std::string>{"lag(y, 1)", "lag(u, 1)/(K + lag(u, 1))"});
  CHECK(found.summary.at("discovery").at("inside_terms").at(0).at("regression").get<double>() ==
        doctest::Approx(0.5).epsilon(0.03).scale(0));
  CHECK(found.out.find("parameters inside terms") != std::string::npos);

  // sds of coefficients and K together, from the slopes of all three.
  double const K = found.summary.at("discovery").at("inside_terms").at(0).at("regression");
  auto const kept_term = [&](std::size_t index) -> json const& {
    std::size_t count = 0;
    for (json const& term : equation.at("terms"))
      if (term.at("kept").get<bool>() && count++ == index) return term;
    throw std::out_of_range("term");
  };
  double const a = kept_term(0).at("coefficient"), b = kept_term(1).at("coefficient");
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double squares = 0;
  for (std::size_t i = 1; i < ys.size(); ++i) {
    double const u = us[i - 1], share = u / (K + u);
    Eigen::Vector3d const slopes(ys[i - 1], share, -b * share / (K + u));
    products += slopes * slopes.transpose();
    squares += std::pow(ys[i] - a * ys[i - 1] - b * share, 2);
  }
  Eigen::MatrixXd const covariance = inverse(products) * squares / static_cast<double>(ys.size() - 4);
  CHECK(kept_term(0).at("sd").get<double>() == doctest::Approx(std::sqrt(covariance(0, 0))).epsilon(0.03).scale(0));
  CHECK(kept_term(1).at("sd").get<double>() == doctest::Approx(std::sqrt(covariance(1, 1))).epsilon(0.03).scale(0));
  CHECK(found.summary.at("discovery").at("inside_terms").at(0).at("regression_sd").get<double>() ==
        doctest::Approx(std::sqrt(covariance(2, 2))).epsilon(0.03).scale(0));
}

TEST_CASE("a value at the edge of its prior has no sd by curvature, and the report says so") {
  Stream input({4, Purpose::input, 0, 0}), noise({4, Purpose::noise, 0, 0});
  std::string csv = "u,y\n";
  double y = 0;
  for (int i = 0; i < 300; ++i) {
    double const u = std::abs(input.normal());
    csv += fmt::format("{:.15g},{:.15g}\n", u, y);
    y = 0.7 * y + 2 * u / (0.5 + u) + 0.02 * noise.normal();
  }
  Found const found(csv,
                    "time discrete\ninput u\nstate y = y\nparameter K ~ uniform(0.01, 0.2)\ntarget = y\n"
                    "terms = lag(y, 1), lag(u, 1)/(K + lag(u, 1))\n",
                    "step 1 [s]; input u = u; measure y = y\n", "spike_slab, ");
  json const& K = found.summary.at("discovery").at("inside_terms").at(0);
  CHECK(K.at("regression").get<double>() > 0.19);
  CHECK(K.at("regression_sd").is_null());
}

TEST_CASE("a record that no value explains ends with the findings of any other") {
  std::string csv = "t,x\n";
  for (int i = 0; i < 60; ++i) csv += fmt::format("{},1\n", i);
  TemporaryFolder folder;
  write_file(folder.path() / "made.csv", csv);
  RunOptions run;
  run.output = folder.path() / "results";
  RunResult const result = run_text(folder.path() / "made.sysid",
                                    "dictionary made { state x = x\n parameter K ~ uniform(0.1, 1)\n target = x'\n terms = x, "
                                    "x/(K + x) }\ndata record { file \"made.csv\"; time t [s]; measure x = x }\n"
                                    "found = discover made from record with spike_slab, seed = 1\n",
                                    run);
  CHECK(result.exit == 1);
  CHECK(result.out.find("record_at_rest") != std::string::npos);
}

TEST_CASE("a value that the prior does not expect is said, and a constant in the prior is in what is written") {
  Found const found(grazing(1, 0.01),
                    "constant middle = 2.5\nstate x = x, y = y\nparameter K ~ normal(middle, sd = 0.05)\ntarget = x', y'\n"
                    "terms = x, x^2, y, x*y/(K + x)\n",
                    columns, "");
  bool said = false;
  for (json const& each : found.summary.at("findings")) said = said || each.at("code") == "prior_contradicted";
  CHECK(said);
  CHECK(found.source.find("constant  middle = 2.5") != std::string::npos);
}

TEST_CASE("three parameters in two terms are found from priors of decades") {
  Stream input({11, Purpose::input, 0, 0}), noise({11, Purpose::noise, 0, 0});
  std::string csv = "t,u,x\n";
  double x = 0.3, u = 0.4;
  for (int i = 0; i < 600; ++i) {
    if (i % 15 == 0) u = 4 * input.uniform();
    csv += fmt::format("{:.6g},{:.9g},{:.9g}\n", 0.1 * i, u, x + 0.006 * noise.normal());
    auto const rate = [&](double at) { return 2 * u * u / (1 + u * u) - 1.2 * at / (0.5 + at); };
    for (int k = 0; k < 20; ++k) {
      double const h = 0.005, a = rate(x), b = rate(x + h / 2 * a), c = rate(x + h / 2 * b), d = rate(x + h * c);
      x += h / 6 * (a + 2 * b + 2 * c + d);
    }
  }
  Found const found(csv,
                    "input u\nstate x = x\nparameter K ~ log_uniform(0.05, 20)\nparameter n ~ uniform(1, 4)\n"
                    "parameter Kx ~ log_uniform(0.05, 20)\ntarget = x'\nterms = x, x^2, u, u^2, 1, u^n/(K^n + u^n), x/(Kx + x)\n",
                    "time t [s]; input u = u hold zero_order; measure x = x\n", "");
  CHECK(found.first().at("terms") == "u^n/(K^n + u^n), x/(Kx + x)");
  double const truth[] = {1, 2, 0.5};
  int k = 0;
  for (char const* name : {"K", "n", "Kx"}) {
    json const each = found.coefficient("", name);
    REQUIRE(!each.is_null());
    CAPTURE(name);
    CHECK(std::abs(each.at("value").get<double>() - truth[k++]) < 3.5 * each.at("sd").get<double>());
  }
}

TEST_CASE("one that no term which is kept reads stands in no model") {
  Stream noise({5, Purpose::noise, 0, 0});
  std::string csv = "t,x\n";
  for (int i = 0; i < 150; ++i)
    csv += fmt::format("{:.6g},{:.12g}\n", 0.05 * i, 2 * std::exp(-0.7 * 0.05 * i) + 0.002 * noise.normal());
  Found const found(csv, "state x = x\nparameter K ~ log_uniform(0.1, 10)\ntarget = x'\nterms = x, x^2, x^3, x^2/(K + x^2)\n",
                    "time t [s]; measure x = x\n", "");
  CHECK(found.first().at("terms") == "x");
  CHECK(found.source.find("parameter K") == std::string::npos);
}
