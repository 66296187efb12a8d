// Planted systems that the regression alone does not find, through the whole program.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>

#include "core/numeric/random.hpp"
#include "discovery/discovering.hpp"

using namespace sysid;
using namespace sysid::test;
using json = nlohmann::json;

namespace {

using Pair = std::array<double, 2>;
using Rates = std::function<Pair(Pair const&)>;

/// 150 samples of two states, Runge and Kutta's steps of a hundredth of a sample; noise in proportion to each value, or of this
/// part of a channel's sd; written with so many digits.
struct Trial {
  Rates rates;
  Pair start;
  double length;
  double proportional = 0, constant = 0;
  int digits = 15;
  std::uint64_t seed = 1;

  std::string csv() const {
    constexpr int rows = 150, steps = 100;
    double const h = length / (rows - 1) / steps;
    std::vector<Pair> motion = {start};
    Pair at = start;
    auto const plus = [](Pair const& a, double by, Pair const& b) { return Pair{a[0] + by * b[0], a[1] + by * b[1]}; };
    while (motion.size() < rows) {
      for (int i = 0; i < steps; ++i) {
        Pair const k1 = rates(at), k2 = rates(plus(at, h / 2, k1)), k3 = rates(plus(at, h / 2, k2)), k4 = rates(plus(at, h, k3));
        for (std::size_t s = 0; s < 2; ++s) at[s] += h / 6 * (k1[s] + 2 * k2[s] + 2 * k3[s] + k4[s]);
      }
      motion.push_back(at);
    }
    Pair mean{}, sd{};
    for (Pair const& each : motion)
      for (std::size_t s = 0; s < 2; ++s) mean[s] += each[s] / rows;
    for (Pair const& each : motion)
      for (std::size_t s = 0; s < 2; ++s) sd[s] += std::pow(each[s] - mean[s], 2) / rows;
    std::array<Stream, 2> noise{Stream({seed, Purpose::noise, 0, 0}), Stream({seed, Purpose::noise, 1, 0})};
    std::string text = "t,x,y\n";
    for (int i = 0; i < rows; ++i) {
      text += fmt::format("{:.15g}", i * length / (rows - 1));
      for (std::size_t s = 0; s < 2; ++s) {
        double const value = motion[static_cast<std::size_t>(i)][s];
        text += fmt::format(
            ",{:.{}g}", value * (1 + proportional * noise[s].normal()) + constant * std::sqrt(sd[s]) * noise[s].normal(), digits);
      }
      text += "\n";
    }
    return text;
  }

  json found(std::string const& terms) const {
    std::string const text = "dictionary d {\nstate x = x, y = y\ntarget = x', y'\nterms = " + terms +
                             "\n}\ndata record { file \"record.csv\"; time t; measure x = x; measure y = y }\n"
                             "found = discover d from record with seed = 1\n";
    DiscoveryAnswer const answer = run_with(text, {{"record.csv", csv()}});
    REQUIRE_MESSAGE(answer.summary.contains("discovery"), answer.said);
    return answer.summary.at("discovery").at("judged").at("structures").at(0);
  }
};

std::string const narrow = "polynomial(x, y, degree = 3), 1, sin(x), cos(x), sin(y), cos(y)";
std::string const wide = narrow +
                         ", exp(x), exp(y), x/(1 + x), y/(1 + y), x^2/(1 + x^2), y^2/(1 + y^2), x*sin(x), x*cos(x), x*sin(y), "
                         "x*cos(y), y*sin(x), y*cos(x), y*sin(y), y*cos(y)";

Pair hunting(Pair const& s) { return {1.1 * s[0] - 0.5 * s[0] * s[1], -s[1] + 0.4 * s[0] * s[1]}; }
Pair competing(Pair const& s) {
  return {1.2 * s[0] - 0.3 * s[0] * s[0] - 0.2 * s[0] * s[1], 0.9 * s[1] - 0.25 * s[1] * s[1] - 0.1 * s[0] * s[1]};
}

}  // namespace

TEST_CASE("a record that is exact to its digits gives exactly its terms, and none of the size of the last digit") {
  for (int const digits : {7, 15}) {
    CAPTURE(digits);
    Trial const record{.rates = hunting, .start = {4, 1.5}, .length = 12, .digits = digits};
    CHECK(record.found(narrow).at("terms") == "x': x, x*y; y': y, x*y");
    CHECK(record.found(wide).at("terms") == "x': x, x*y; y': y, x*y");
  }
}

TEST_CASE("noise that grows with the signal is named, and the terms are found with it") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Trial const record{.rates = hunting, .start = {4, 1.5}, .length = 12, .proportional = 0.05, .seed = seed};
    json const first = record.found(narrow);
    CHECK(first.at("terms") == "x': x, x*y; y': y, x*y");
    for (json const& channel : first.at("channels")) CHECK(channel.at("noise_grows_beyond").is_number());
  }
  Trial const record{.rates = hunting, .start = {4, 1.5}, .length = 12, .constant = 0.05};
  json const first = record.found(narrow);
  CHECK(first.at("terms") == "x': x, x*y; y': y, x*y");
  for (json const& channel : first.at("channels")) CHECK(channel.at("noise_grows_beyond").is_null());
}

TEST_CASE("terms that the regression exchanges for others are found by simulation") {
  // By the regression x' = sin(x), y^2 and the like: four swaps from the truth. With noise of 1 % the record does not tell: such
  // forms have a log likelihood within two of that of the true one, and as many terms.
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Trial const record{.rates = competing, .start = {0.5, 0.4}, .length = 12, .proportional = 0.001, .seed = seed};
    CHECK(record.found(narrow).at("terms") == "x': x, x^2, x*y; y': y, x*y, y^2");
  }
}
