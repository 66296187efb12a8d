// Chaotic motion, where the likelihood of a long segment has many optima of nearly one height.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "discovery/discovering.hpp"

using namespace sysid;
using namespace sysid::test;
using json = nlohmann::json;

namespace {

using Point = std::array<double, 3>;

/// 8 s of a flow in 1000 samples, Runge and Kutta's steps of 0.1 ms; each sample times 1 + 1 % of a normal number.
template <class Rates>
std::string noisy_flow(Rates const& rates, Point at) {
  constexpr int rows = 1000, steps = 80;
  constexpr double length = 8.0, h = length / (rows - 1) / steps;
  auto const plus = [](Point a, double by, Point const& b) {
    for (std::size_t i = 0; i < 3; ++i) a[i] += by * b[i];
    return a;
  };
  std::array<Stream, 3> noise{Stream({1, Purpose::noise, 0, 0}), Stream({1, Purpose::noise, 1, 0}),
                              Stream({1, Purpose::noise, 2, 0})};
  std::string text = "t,x,y,z\n";
  for (int row = 0; row < rows; ++row) {
    text += fmt::format("{:.12g}", row * length / (rows - 1));
    for (std::size_t i = 0; i < 3; ++i) text += fmt::format(",{:.10g}", at[i] * (1 + 0.01 * noise[i].normal()));
    text += "\n";
    for (int i = 0; i < steps; ++i) {
      Point const k1 = rates(at), k2 = rates(plus(at, h / 2, k1)), k3 = rates(plus(at, h / 2, k2)), k4 = rates(plus(at, h, k3));
      at = plus(plus(plus(plus(at, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    }
  }
  return text;
}

}  // namespace

TEST_CASE("coefficients of a chaotic flow are known as well as their sds say, however far it is followed") {
  auto const chen = [](Point const& s) {
    return Point{35 * (s[1] - s[0]), -7 * s[0] - s[0] * s[2] + 28 * s[1], s[0] * s[1] - 3 * s[2]};
  };
  std::string const text =
      "dictionary d {\nstate x = x, y = y, z = z\ntarget = x', y', z'\nterms = 1, polynomial(x, y, z, degree = 2)\n}\n"
      "data record { file \"record.csv\"; time t; measure x = x; measure y = y; measure z = z }\n"
      "found = discover d from record with seed = 1\n";
  DiscoveryAnswer const answer = run_with(text, {{"record.csv", noisy_flow(chen, {-3, 2, 20})}});
  json const& first = answer.summary.at("discovery").at("judged").at("structures").at(0);
  REQUIRE(first.at("terms") == "x': x, y; y': x, y, x*z; z': z, x*y");
  std::array<double, 7> const truth = {-35, 35, -7, 28, -1, -3, 1};
  for (std::size_t j = 0; j < truth.size(); ++j) {
    json const& each = first.at("coefficients").at(j);
    CAPTURE(each.dump());
    CHECK(std::abs(each.at("value").get<double>() - truth[j]) < 3.5 * each.at("sd").get<double>());
  }
}
