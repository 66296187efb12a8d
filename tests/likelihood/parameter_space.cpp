// Rows, names and the joint prior of parameters over several experiments, against densities written out by hand.
#include "likelihood/parameter_space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text/diagnostic.hpp"
#include "load/load.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

Model model_with(std::string const& parameters) {
  Source source("case.sysid",
                "model m {\ninput x\nstate y\ninitial y = 0\n" + parameters + "\ny' = x\nobserve level ~ normal(y, sd = 1)\n}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

std::string const hierarchy =
    "parameter mu [N/mm] ~ normal(10, sd = 2)\n"
    "parameter tau [N/mm] ~ half_normal(3)\n"
    "parameter k per experiment [N/mm] ~ normal(mu, sd = tau, lower = 0)\n"
    "parameter m per experiment [kg] = 2\n"
    "parameter s ~ log_uniform(1, 10)\n";

double normal_log_density(double x, double mean, double sd) {
  return -0.5 * std::log(2 * std::numbers::pi) - std::log(sd) - 0.5 * (x - mean) * (x - mean) / (sd * sd);
}
double phi(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

std::vector<std::optional<double>> constants(std::initializer_list<std::pair<int, double>> given) {
  std::vector<std::optional<double>> values(5);
  for (auto const& [p, value] : given) values[static_cast<std::size_t>(p)] = value;
  return values;
}

}  // namespace

TEST_CASE("an experiment's own parameter is named by it, also where it has an index already") {
  CHECK(member_name("k", "bench") == "k[bench]");
  CHECK(member_name("k", "bench.train") == "k[bench.train]");
  CHECK(member_name("q[2]", "bench") == "q[2,bench]");
  CHECK(member_name("k", "") == "k");
}

TEST_CASE("own parameters take a row per experiment in their place; what a data block fixes is not sampled") {
  ParameterSpace const space(model_with(hierarchy),
                             {{"a", constants({})}, {"b", constants({{2, 8e3}})}, {"c", constants({{3, 7}})}});
  std::vector<std::string> rows, sampled;
  for (FittedParameter const& row : space.rows()) rows.push_back(row.name);
  for (ParameterInfo const& info : space.infos()) sampled.push_back(info.name);
  CHECK(rows == std::vector<std::string>{"mu", "tau", "k[a]", "k[b]", "k[c]", "m[a]", "m[b]", "m[c]", "s"});
  CHECK(sampled == std::vector<std::string>{"mu", "tau", "k[a]", "k[c]", "s"});
  CHECK(space.infos()[2].lower == 0);
  CHECK(space.infos()[2].unit == "N/mm");

  LaneArray declared(5, 1), parameters(5, 1);
  double const values[] = {9, 2, 11, 7, 3};
  for (int p = 0; p < 5; ++p) declared(p, 0) = values[p];
  auto const of = [&](int experiment) {
    space.select(space.values_of_declared(declared), experiment, parameters);
    std::vector<double> out;
    for (int p = 0; p < 5; ++p) out.push_back(parameters(p, 0));
    return out;
  };
  CHECK(of(0) == std::vector<double>{9e3, 2e3, 11e3, 2, 3});
  CHECK(of(1) == std::vector<double>{9e3, 2e3, 8e3, 2, 3});
  CHECK(of(2) == std::vector<double>{9e3, 2e3, 7e3, 7, 3});
}

TEST_CASE("the joint prior is the product over the experiments given what they share; the Jacobian follows the coordinates") {
  ParameterSpace const space(model_with(hierarchy), {{"a", {}}, {"b", constants({{2, 8e3}})}, {"c", {}}});
  double const values[] = {9, 2, 11, 7, 3};  // mu, tau, k[a], k[c], s
  LaneArray declared(5, 1), theta(5, 1), back(5, 1);
  for (int p = 0; p < 5; ++p) declared(p, 0) = values[p];
  space.unconstrain(declared, theta);
  space.constrain(theta, back);
  for (int p = 0; p < 5; ++p) CHECK(back(p, 0) == doctest::Approx(values[p]).epsilon(1e-12));
  std::vector<double> out(1), with(1);
  space.log_prior(theta, out, false);
  space.log_prior(theta, with, true);
  // The fixed member is no draw from the population.
  double const by_hand = normal_log_density(9, 10, 2) + std::log(2.0) + normal_log_density(2, 0, 3) + normal_log_density(11, 9, 2) +
                         normal_log_density(7, 9, 2) - 2 * std::log(phi(9.0 / 2)) - std::log(3 * std::log(10.0));
  CHECK(out[0] == doctest::Approx(by_hand).epsilon(1e-11));
  // mu moves freely in SI, tau and the ks by a logarithm, s between its logarithmic bounds.
  double const share = std::log(3.0) / std::log(10.0);
  double const jacobian =
      -std::log(1e3) + std::log(2.0) + std::log(11.0) + std::log(7.0) + std::log(3 * std::log(10.0) * share * (1 - share));
  CHECK(with[0] - out[0] == doctest::Approx(jacobian).epsilon(1e-9));
}

TEST_CASE("draws from a hierarchical prior have the moments of the population") {
  ParameterSpace const space(model_with("parameter mu ~ normal(1, sd = 2)\nparameter k per experiment ~ normal(mu, sd = 0.5)"),
                             {{"a", {}}, {"b", {}}});
  int const n = 20000;
  LaneArray theta(3, n), declared(3, n);
  space.sample_prior({7, Purpose::prior, 0, 0}, theta);
  space.constrain(theta, declared);
  double within = 0, between = 0, mean = 0;
  for (int w = 0; w < n; ++w) {
    double const a = declared(1, w), b = declared(2, w);
    mean += a / n;
    within += (a - b) * (a - b) / 2 / n;
    between += (a - 1) * (b - 1) / n;
  }
  // Variances 0.25 within and 4 between; relative standard errors sqrt(2/n) and below 2 sqrt(2/n).
  CHECK(std::abs(mean - 1) < 4 * std::sqrt(4.25 / n));
  CHECK(within == relative(0.25, 4 * std::sqrt(2.0 / n)));
  CHECK(between == doctest::Approx(4).epsilon(8 * std::sqrt(2.0 / n)));
}

TEST_CASE("a new experiment draws its own parameters given the shared ones and takes its constants as they are") {
  ParameterSpace const space(model_with(hierarchy), {{"a", {}}, {"b", {}}});
  int const n = 20000;
  LaneArray declared(space.dimension(), n);
  for (int w = 0; w < n; ++w) {
    declared(0, w) = 50;                     // mu
    declared(1, w) = w < n / 2 ? 1.0 : 2.0;  // tau
    declared(2, w) = declared(3, w) = 1;     // of the fitted experiments: of no concern
    declared(4, w) = 3;
  }
  LaneArray const drawn = space.of_new_experiment(declared, constants({{3, 9}}), {3, Purpose::population, 0, 0});
  double narrow = 0, wide = 0;
  for (int w = 0; w < n; ++w) {
    double const z = drawn(2, w) / 1e3 - 50;
    (w < n / 2 ? narrow : wide) += z * z / (n / 2);
    CHECK(drawn(3, w) == 9);
  }
  CHECK(narrow == doctest::Approx(1).epsilon(4 * std::sqrt(4.0 / n)));
  CHECK(wide == doctest::Approx(4).epsilon(4 * std::sqrt(4.0 / n)));
  LaneArray const fixed = space.of_new_experiment(declared, constants({{2, 6e3}}), {3, Purpose::population, 0, 0});
  CHECK(fixed(2, 0) == 6e3);
  CHECK(fixed(3, 0) == 2);
}

TEST_CASE("the slopes of values by coordinates are those of differences, also at 0 and through estimated bounds") {
  ParameterSpace const space(model_with("parameter free ~ normal(0, sd = 1)\n"
                                        "parameter positive ~ half_normal(2)\n"
                                        "parameter negative ~ normal(0, sd = 1, upper = 3)\n"
                                        "parameter between ~ uniform(-1, 2)\n"
                                        "parameter decades ~ log_uniform(0.1, 1000)\n"
                                        "parameter share ~ beta(2, 3)\n"
                                        "parameter own per experiment ~ normal(free, sd = positive)\n"
                                        "parameter tied per experiment ~ uniform(-positive, positive + 2*share)\n"),
                             {{"a", {}}, {"b", {}}});
  int const rows = static_cast<int>(space.rows().size()), dimension = space.dimension();
  LaneArray theta(dimension, 3);
  space.sample_prior({3, Purpose::prior, 0, 0}, theta);
  for (int p = 0; p < dimension; ++p) theta(p, 2) = 0;
  LaneArray slopes(static_cast<int>(space.slopes().size()), 3);
  space.slopes(theta, slopes);
  constexpr double h = 1e-5;
  for (int c = 0; c < dimension; ++c) {
    LaneArray ahead = theta, behind = theta;
    for (int w = 0; w < 3; ++w) ahead(c, w) += h, behind(c, w) -= h;
    LaneArray const up = space.values(ahead), down = space.values(behind);
    for (int r = 0; r < rows; ++r)
      for (int w = 0; w < 3; ++w) {
        double found = 0;
        for (std::size_t s = 0; s < space.slopes().size(); ++s)
          if (space.slopes()[s].row == r && space.slopes()[s].coordinate == c) found = slopes(static_cast<int>(s), w);
        double const expected = (up(r, w) - down(r, w)) / (2 * h);
        CHECK(found == doctest::Approx(expected).epsilon(1e-7).scale(1));
        auto const& read = space.coordinates_of(r);
        if (expected != 0) CHECK(std::find(read.begin(), read.end(), c) != read.end());
      }
  }
}

namespace {

std::string const members =
    "parameter mu [N/mm] ~ normal(10, sd = 2)\n"
    "parameter tau [N/mm] ~ half_normal(3)\n"
    "parameter spread ~ half_normal(1)\n"
    "parameter k per experiment [N/mm] ~ normal(mu, sd = tau)\n"
    "parameter c per experiment [N/mm] ~ log_normal(median = 2 [N/mm], log_sd = spread)\n"
    "parameter t per experiment [N/mm] ~ student_t(mu, 4, scale = tau)\n"
    "parameter bounded per experiment [N/mm] ~ normal(mu, sd = tau, lower = 0)\n"
    "parameter known per experiment [N/mm] ~ normal(mu, sd = 3 [N/mm])\n";

/// What the data say of the first six of them: much of one, little of another, nothing of a third.
std::vector<MemberCoordinate> const standardised = {{3, 1e-4, 1.1}, {4, 1e-8, 1e-4}, {5, 40, 35},
                                                    {6, 0, 0},      {7, 1e-6, 0},    {8, 1e-7, -1e-3}};

}  // namespace

TEST_CASE("members of a hierarchy are those whose prior is moved and widened by sampled parameters") {
  ParameterSpace const space(model_with(members), {{"a", {}}, {"b", {}}});
  std::vector<std::string> names;
  for (ParameterSpace::Member const& member : space.members()) {
    names.push_back(space.infos()[static_cast<std::size_t>(member.coordinate)].name);
    CHECK(member.population == std::vector<int>{names.back().starts_with('c') ? 2 : 1});
  }
  CHECK(names == std::vector<std::string>{"k[a]", "k[b]", "c[a]", "c[b]", "t[a]", "t[b]"});
  LaneArray declared(space.dimension(), 1), theta(space.dimension(), 1), scales(6, 1);
  double const values[] = {9, 2, 0.5, 11, 7, 3, 2, 8, 10, 6, 5, 4, 3};
  for (int p = 0; p < space.dimension(); ++p) declared(p, 0) = values[p];
  space.unconstrain(declared, theta);
  space.member_scales(theta, scales);
  CHECK(scales(0, 0) == doctest::Approx(2000));
  CHECK(scales(3, 0) == doctest::Approx(0.5));
}

TEST_CASE("coordinates of members given their population change the density by their Jacobian alone") {
  std::vector<ExperimentMember> const experiments = {{"a", {}}, {"b", {}}};
  ParameterSpace const plain(model_with(members), experiments), space(model_with(members), experiments, standardised);
  int const dimension = space.dimension(), width = 3;
  LaneArray theta(dimension, width), declared(dimension, width), back(dimension, width), there(dimension, width);
  plain.sample_prior({3, Purpose::prior, 0, 0}, there);
  plain.constrain(there, declared);
  space.unconstrain(declared, theta);
  space.constrain(theta, back);
  for (int p = 0; p < dimension; ++p)
    for (int w = 0; w < width; ++w) CHECK(back(p, w) == doctest::Approx(declared(p, w)).epsilon(1e-9));

  std::vector<double> density(width), with(width), plain_density(width), plain_with(width);
  space.log_prior(theta, density, false);
  space.log_prior(theta, with, true);
  plain.log_prior(there, plain_density, false);
  plain.log_prior(there, plain_with, true);
  // Coordinates of members read those of the populations, which are the same in both: the Jacobian is triangular.
  LaneArray slopes(static_cast<int>(space.slopes().size()), width), plain_slopes(static_cast<int>(plain.slopes().size()), width);
  space.slopes(theta, slopes);
  plain.slopes(there, plain_slopes);
  auto const log_own = [](ParameterSpace const& of, LaneArray const& values, int w) {
    double sum = 0;
    for (std::size_t s = 0; s < of.slopes().size(); ++s)
      if (of.sampled()[static_cast<std::size_t>(of.slopes()[s].coordinate)] == of.slopes()[s].row)
        sum += std::log(values(static_cast<int>(s), w));
    return sum;
  };
  for (int w = 0; w < width; ++w) {
    auto const at = static_cast<std::size_t>(w);
    CHECK(density[at] == doctest::Approx(plain_density[at]).epsilon(1e-9));
    CHECK(with[at] - plain_with[at] == doctest::Approx(log_own(space, slopes, w) - log_own(plain, plain_slopes, w)).epsilon(1e-9));
  }
}

TEST_CASE("a spread below the last digit of the mean leaves the density of a member's coordinate as it is") {
  std::string const far =
      "parameter mu ~ normal(2e7, sd = 1e5)\nparameter tau ~ log_uniform(1e-12, 1e6)\nparameter k per experiment ~ normal(mu, sd = "
      "tau)\n";
  for (MemberCoordinate const& member : {MemberCoordinate{2, 0, 0}, MemberCoordinate{2, 1e-10, 2e-3}}) {
    ParameterSpace const space(model_with(far), {{"a", {}}}, {member});
    LaneArray theta(3, 2);
    theta(0, 0) = theta(0, 1) = 2e7;
    theta(1, 0) = theta(1, 1) = std::log(1e-11 / (1e6 - 1e-11));  // near the lower bound, whatever the form of the coordinate
    theta(2, 0) = 0;
    theta(2, 1) = 2;
    LaneArray declared(3, 2);
    space.constrain(theta, declared);
    REQUIRE(declared(1, 0) < 1e-9);
    std::vector<double> density(2);
    space.log_prior(theta, density, true);
    CHECK(density[1] - density[0] == doctest::Approx(-2).epsilon(1e-6));
  }
}

TEST_CASE("slopes of members and the gradient of their prior are those of differences") {
  ParameterSpace const space(model_with(members), {{"a", {}}, {"b", {}}}, standardised);
  int const rows = static_cast<int>(space.rows().size()), dimension = space.dimension(), width = 2;
  LaneArray theta(dimension, width), slopes(static_cast<int>(space.slopes().size()), width), gradient(dimension, width);
  space.sample_prior({3, Purpose::prior, 0, 0}, theta);
  space.slopes(theta, slopes);
  std::vector<double> density(width), ahead_density(width), behind_density(width);
  REQUIRE(space.log_prior_gradient(theta, density, gradient));
  for (int c = 0; c < dimension; ++c) {
    LaneArray ahead = theta, behind = theta;
    double const h = 1e-6 * std::max(1.0, std::abs(theta(c, 0)));
    for (int w = 0; w < width; ++w) ahead(c, w) += h, behind(c, w) -= h;
    LaneArray const up = space.values(ahead), down = space.values(behind);
    space.log_prior(ahead, ahead_density, true);
    space.log_prior(behind, behind_density, true);
    for (int w = 0; w < width; ++w) {
      auto const at = static_cast<std::size_t>(w);
      CHECK(gradient(c, w) == doctest::Approx((ahead_density[at] - behind_density[at]) / (2 * h)).epsilon(1e-5).scale(1));
      for (int r = 0; r < rows; ++r) {
        double found = 0;
        for (std::size_t s = 0; s < space.slopes().size(); ++s)
          if (space.slopes()[s].row == r && space.slopes()[s].coordinate == c) found = slopes(static_cast<int>(s), w);
        double const expected = (up(r, w) - down(r, w)) / (2 * h);
        CHECK(found == doctest::Approx(expected).epsilon(1e-6).scale(std::abs(up(r, w))));
      }
    }
  }
}
