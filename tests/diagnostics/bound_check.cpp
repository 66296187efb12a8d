// The bound check fires where a bound decides the posterior, and only there.
#include "diagnostics/bound_check.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

std::vector<double> draws_of(std::function<double(Stream&)> const& draw, int n = 2000) {
  Stream stream({5, Purpose::test, 0, 0});
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(draw(stream));
  return x;
}

}  // namespace

TEST_CASE("a posterior that leans on a bound of its prior is found, at the right side") {
  auto const near_zero = draws_of([](Stream& s) { return 0.1 * std::fabs(s.normal()); });
  CHECK(check_bounds(near_zero, 0, 1).at_lower);
  CHECK_FALSE(check_bounds(near_zero, 0, 1).at_upper);
  auto const near_ten = draws_of([](Stream& s) { return 10 + std::log(s.uniform()); });
  CHECK(check_bounds(near_ten, 0, 10).at_upper);
  CHECK_FALSE(check_bounds(near_ten, 0, 10).at_lower);
}

TEST_CASE("over decades the bounds are judged on a log scale") {
  // Log-normal about 3, sd 0.5 in ln: on a linear scale it would seem to sit at the lower bound of (1e-3, 1e3).
  auto const middle = draws_of([](Stream& s) { return 3 * std::exp(0.5 * s.normal()); });
  CHECK_FALSE(check_bounds(middle, 1e-3, 1e3).at_lower);
  auto const low = draws_of([](Stream& s) { return 1e-3 * std::exp(0.5 * std::fabs(s.normal())); });
  CHECK(check_bounds(low, 1e-3, 1e3).at_lower);
}

TEST_CASE("sound, flat, one-sided and standing posteriors are left alone") {
  auto const sound = draws_of([](Stream& s) { return 5 + s.normal(); });
  CHECK_FALSE(check_bounds(sound, 0, 10).at_lower);
  CHECK_FALSE(check_bounds(sound, 0, 10).at_upper);
  auto const flat = draws_of([](Stream& s) { return s.uniform(); });
  CHECK_FALSE(check_bounds(flat, 0, 1).at_lower);
  auto const scale = draws_of([](Stream& s) { return std::fabs(s.normal()); });
  CHECK_FALSE(check_bounds(scale, 0, infinity).at_lower);
  CHECK_FALSE(check_bounds(std::vector<double>(500, 0.0), 0, 1).at_lower);
  CHECK_FALSE(check_bounds(std::vector<double>(10, 0.0), 0, 1).at_lower);
  auto const three_sds_off = draws_of([](Stream& s) { return std::fabs(0.3 + 0.1 * s.normal()); });
  CHECK_FALSE(check_bounds(three_sds_off, 0, 10).at_lower);
}

TEST_CASE("one bound alone counts if it is no zero and the posterior is narrower than its prior") {
  auto const above = draws_of([](Stream& s) { return 3.4 - 0.03 * std::log(s.uniform()); });
  CHECK(check_bounds(above, 3.4, infinity, infinity).at_lower);
  CHECK(check_bounds(above, 3.4, infinity, 10).at_lower);
  CHECK_FALSE(check_bounds(above, 3.4, infinity, 0.1).at_lower);  // of the prior's own width
  CHECK_FALSE(check_bounds(above, 3.4, infinity).at_lower);       // which is not known
  CHECK_FALSE(check_bounds(above, 3.3, infinity, infinity).at_lower);
  auto const below = draws_of([](Stream& s) { return -0.03 * std::fabs(s.normal()); });
  CHECK(check_bounds(below, -infinity, 0, infinity).at_upper == false);
  auto const below_two = draws_of([](Stream& s) { return 2 - 0.03 * std::fabs(s.normal()); });
  CHECK(check_bounds(below_two, -infinity, 2, infinity).at_upper);
}

TEST_CASE("the finding names the parameter, the bound and its unit") {
  auto const x = draws_of([](Stream& s) { return 1e5 - 100 * std::fabs(s.normal()); });
  Draws draws{{"k", "c"}, {"N/m", ""}, {{}}, 2};
  for (double const v : x) draws.chains[0].values.push_back({v, v});
  std::vector<ParameterInfo> const infos = {{"k", "N/m", 1e3, 1e5}, {"c", "", -infinity, infinity}};
  Findings const findings = check_bounds(infos, draws);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].code == FindingCode::piles_up_at_bound);
  CHECK(findings[0].message == "the posterior of k is concentrated at the upper bound of its prior, 1e+05 N/m");
}

TEST_CASE("a bound of 0 alone is natural, but not where the fit explains nothing, and of a size always") {
  auto const x = draws_of([](Stream& s) { return 0.01 * std::fabs(s.normal()); });
  Draws draws{{"b"}, {""}, {{}}, 1};
  for (double const v : x) draws.chains[0].values.push_back({v});
  std::vector<ParameterInfo> infos = {{"b", "", 0, infinity}};
  PriorInfo prior{"b", "", "half_normal(sd = 1)", {}};
  prior.q5 = 0.06, prior.q95 = 1.96;
  std::vector<PriorInfo> const priors = {prior};
  CHECK(check_bounds(infos, draws, priors).empty());
  CHECK(check_bounds(infos, draws, priors, true).size() == 1);
  infos[0].size_alone = true;
  CHECK(check_bounds(infos, draws, priors, true).empty());
}

TEST_CASE("a uniform prior over decades is compared on its own scale") {
  // More than half as wide as the prior; in logarithms narrow, and densest at its upper end.
  auto const x = draws_of([](Stream& s) { return 20 + 29.5 * s.uniform(); });
  CHECK(check_bounds(x, 1, 50).at_upper);
  CHECK_FALSE(check_bounds(x, 1, 50, 0, {.logarithmic = false}).at_upper);
  Draws draws{{"f"}, {"Hz"}, {{}}, 1};
  for (double const v : x) draws.chains[0].values.push_back({v});
  std::vector<ParameterInfo> const infos = {{"f", "Hz", 1, 50}};
  PriorInfo prior{"f", "Hz", "uniform(1, 50)", {}};
  CHECK(check_bounds(infos, draws, std::vector<PriorInfo>{prior}).size() == 1);
  prior.numbers = PriorNumbers{"uniform", {1, 50}, 1, 50, 1};
  CHECK(check_bounds(infos, draws, std::vector<PriorInfo>{prior}).empty());
}

TEST_CASE("a lower bound that is not negative may be reached by a wrong sign") {
  auto const help = [](double lower, double upper, bool at_lower, bool size_alone = false) {
    auto const x = draws_of([&](Stream& s) {
      double const off = 1e-3 * (upper - lower) * std::fabs(s.normal());
      return at_lower ? lower + off : upper - off;
    });
    Draws draws{{"c"}, {""}, {{}}, 1};
    for (double const v : x) draws.chains[0].values.push_back({v});
    Findings const findings =
        check_bounds(std::vector<ParameterInfo>{{"c", "", lower, upper, false, Improper::no, size_alone}}, draws);
    REQUIRE(findings.size() == 1);
    return findings[0].help;
  };
  CHECK(help(1, 5, true).ends_with("if `c` moves to a smaller bound again, a sign in the equation or in the data may be wrong"));
  CHECK(help(0, 5, true).ends_with("to allow negative values, use `c ~ normal(0, sd = ...)`"));
  CHECK(help(0, 5, false).find("sign") == std::string::npos);
  CHECK(help(-5, 5, true).find("sign") == std::string::npos);
  CHECK(help(0, 5, true, true).find("sign") == std::string::npos);  // a sd is never negative
}
