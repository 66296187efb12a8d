// Optima at bounds of priors, against those of a regression with the parameter fixed there.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "app/running.hpp"
#include "relative.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

// A straight line, y = 3 + 2 x.
struct StraightLine {
  static constexpr int rows = 40;
  static constexpr double noise = 0.5;
  std::string csv = "x,y\n";
  double sum_xx = 0, sum_xy = 0, sum_x = 0, sum_y = 0;

  StraightLine() {
    for (int i = 0; i < rows; ++i) {
      double const x = 0.1 * i, y = 3 + 2 * x + 0.4 * std::sin(37.0 * i);
      csv += fmt::format("{},{}\n", x, y);
      sum_xx += x * x, sum_xy += x * y, sum_x += x, sum_y += y;
    }
  }
};

json fit_of_line(std::string const& parameters, std::string const& mean, std::string const& method) {
  std::string const text = "model line {\n  input x [-]\n" + parameters + "  observe y ~ normal(" + mean +
                           ", sd = 0.5)\n}\ndata record { file \"line.csv\"; input x = x; measure y = y }\n" +
                           "best = fit line to record with " + method + ", seed = 1\n";
  return CaseRun(text, {{"line.csv", StraightLine().csv}}).summary("best");
}

json const* told_by(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return &each;
  return nullptr;
}

}  // namespace

TEST_CASE("an optimum at the only bound of a prior is said, and the other parameters are those of the regression there") {
  // The least squares have a = 3: above it, the best is the line with the bound as its offset.
  StraightLine const record;
  double const bound = 3.4;
  double const slope = (record.sum_xy - bound * record.sum_x) / record.sum_xx;
  for (auto const& [prior, method] : {std::pair("flat(lower = 3.4)", "ml"), std::pair("flat(lower = 3.4)", "map"),
                                      std::pair("normal(3, sd = 10, lower = 3.4)", "ml"),
                                      std::pair("normal(3, sd = 10, lower = 3.4)", "map"), std::pair("3.4 + half", "ml")}) {
    CAPTURE(std::string(prior));
    CAPTURE(std::string(method));
    bool const shifted = std::string(prior) == "3.4 + half";  // a distance from the bound
    json const summary = fit_of_line((shifted ? std::string("  parameter d ~ half_normal(5)\n  derive a = 3.4 + d\n")
                                              : fmt::format("  parameter a ~ {}\n", prior)) +
                                         "  parameter b ~ flat()\n  derive both = a + b\n  derive twice = 2*b\n",
                                     "a + b*x", method);
    json const* const told = told_by(summary, "at_bound");
    REQUIRE(told != nullptr);
    CHECK(told->at("message").get<std::string>().find(shifted ? "`d`" : "`a`") != std::string::npos);
    CHECK(told_by(summary, "flat_direction") == nullptr);
    CHECK(told_by(summary, "improper_posterior") == nullptr);
    json const& parameters = summary.at("parameters");
    CHECK(parameters.at("b").at("mean").get<double>() == doctest::Approx(slope).epsilon(1e-6));
    CHECK(parameters.at("b").at("sd").get<double>() == relative(StraightLine::noise / std::sqrt(record.sum_xx), 1e-3));
    CHECK(parameters.at("both").at("sd").is_null());
    CHECK(parameters.at("both").at("without_sd").get<std::string>().find("lies at a bound of its prior") != std::string::npos);
    CHECK(parameters.at("twice").at("sd").is_number());
  }
}

TEST_CASE("an optimum that only comes near its one bound is not called at it") {
  StraightLine const record;
  double const determinant = StraightLine::rows * record.sum_xx - record.sum_x * record.sum_x;
  double const offset = (record.sum_xx * record.sum_y - record.sum_x * record.sum_xy) / determinant,
               sd = StraightLine::noise * std::sqrt(record.sum_xx / determinant);
  for (double const distance : {2.0, 0.5, 0.1}) {
    CAPTURE(distance);
    for (char const* const method : {"ml", "map"}) {
      json const summary =
          fit_of_line(fmt::format("  parameter a ~ flat(lower = {:.17g})\n  parameter b ~ flat()\n", offset - distance * sd),
                      "a + b*x", method);
      CHECK(told_by(summary, "at_bound") == nullptr);
      CHECK(summary.at("parameters").at("a").at("mean").get<double>() == doctest::Approx(offset).epsilon(1e-4));
    }
  }
}

TEST_CASE("a posterior that ends at the one bound of a flat prior is proper") {
  // The least squares have a curvature of 0.05 beside the line.
  for (auto const& [lower, curve] : {std::pair("0", "+ c*x^2"), std::pair("0.3", "- c*x^2")}) {
    CAPTURE(std::string(lower));
    json const summary = fit_of_line(fmt::format("  parameter a ~ normal(0, sd = 10)\n  parameter b ~ normal(0, sd = 10)\n"
                                                 "  parameter c ~ flat(lower = {})\n",
                                                 lower),
                                     fmt::format("a + b*x {}", curve), "map");
    CHECK(told_by(summary, "at_bound") != nullptr);
    CHECK(told_by(summary, "improper_posterior") == nullptr);
  }
}

TEST_CASE("what to do at the lower bound of a positive prior names the sign that may be wrong") {
  // The slope of the record is positive: with a minus before it, it is driven to the end of its prior.
  auto const help = [](char const* prior) {
    json const summary =
        fit_of_line(fmt::format("  parameter a ~ normal(0, sd = 10)\n  parameter b ~ {}\n", prior), "a - b*x", "map");
    json const* const told = told_by(summary, "at_bound");
    return told == nullptr ? std::string("none") : told->at("help").get<std::string>();
  };
  std::string const at_zero = help("half_normal(sd = 10)");
  CHECK(at_zero.find("a sign in the equation or in the data") != std::string::npos);
  CHECK(at_zero.find("`b ~ normal(0, sd = ...)`") != std::string::npos);
  CHECK(at_zero.find("widen") == std::string::npos);
  CHECK(help("log_uniform(0.1, 10)").find("if `b` moves to a smaller bound again, a sign") != std::string::npos);
  CHECK(help("uniform(-0.01, 10)").find("sign") == std::string::npos);
}

TEST_CASE("an optimum many sds from the end of a wide prior is inside, as it is under a prior without that end") {
  for (char const* const method : {"ml", "map"}) {
    CAPTURE(std::string(method));
    json const wide = fit_of_line("  parameter a ~ uniform(0, 1e5)\n  parameter b ~ uniform(0, 5000)\n", "a + b*x", method);
    json const free = fit_of_line("  parameter a ~ flat()\n  parameter b ~ flat()\n", "a + b*x", method);
    CHECK(told_by(wide, "at_bound") == nullptr);
    for (char const* const each : {"a", "b"}) {
      json const &in_wide = wide.at("parameters").at(each), &in_free = free.at("parameters").at(each);
      CHECK(in_wide.at("mean").get<double>() == doctest::Approx(in_free.at("mean").get<double>()).epsilon(1e-5));
      CHECK(in_wide.at("sd").get<double>() == relative(in_free.at("sd").get<double>(), 1e-3));
    }
  }
}

TEST_CASE("a prior whose density is infinite at its bound has no optimum, and that is said") {
  for (char const* const prior : {"gamma(0.5, scale = 1)", "gamma(0.9, scale = 1)", "beta(0.5, 2)"}) {
    CAPTURE(std::string(prior));
    std::string const parameters =
        fmt::format("  parameter a ~ normal(0, sd = 10)\n  parameter b ~ normal(0, sd = 10)\n  parameter c ~ {}\n", prior);
    json const summary = fit_of_line(parameters, "a + b*x + c*x^2", "map");
    json const* const told = told_by(summary, "at_bound");
    REQUIRE(told != nullptr);
    CHECK(told->at("message").get<std::string>().find("has no maximum") != std::string::npos);
    CHECK(told_by(summary, "flat_direction") == nullptr);
    // The likelihood has one: at the bound, or inside.
    json const likelihood = fit_of_line(parameters, "a + b*x + c*x^2", "ml");
    if (json const* const bound = told_by(likelihood, "at_bound"))
      CHECK(bound->at("message").get<std::string>().find("has no maximum") == std::string::npos);
  }
}

TEST_CASE("a log-normal prior whose maximum lies a thousandth of a thousandth of its median away from 0 is climbed to") {
  // The record is straight, and the line too steep: c x^2 is held from above by the data and from below by its prior alone.
  StraightLine const record;
  for (double const sd : {2.5, 3.0, 3.5}) {
    CAPTURE(sd);
    json const summary = fit_of_line(fmt::format("  parameter a ~ flat()\n  parameter c ~ log_normal(0.01, sd = {})\n", sd),
                                     "a + 2.2*x + c*x^2", "map");
    CHECK(told_by(summary, "optimum_not_reached") == nullptr);
    auto const density = [&](double c) {  // at the best a
      double sum = 0, squares = 0;
      for (int i = 0; i < StraightLine::rows; ++i) {
        double const x = 0.1 * i, rest = 3 + 2 * x + 0.4 * std::sin(37.0 * i) - 2.2 * x - c * x * x;
        sum += rest, squares += rest * rest;
      }
      double const far = std::log(c / 0.01) / sd;
      return -(squares - sum * sum / StraightLine::rows) / (2 * 0.5 * 0.5) - far * far / 2 - std::log(c);
    };
    double best = 1e-9;
    for (double c = 1e-9; c < 0.1; c *= 1.0001)
      if (density(c) > density(best)) best = c;
    CHECK(summary.at("parameters").at("c").at("mean").get<double>() == relative(best, 0.01));
  }
}
