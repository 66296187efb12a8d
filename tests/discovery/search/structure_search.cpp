// Planted systems that the regression alone does not find, through the whole program.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
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

/// Samples of two states, Runge and Kutta's steps of a hundredth of a sample; noise in proportion to each value, or of this
/// part of a channel's sd; written with so many digits.
struct Trial {
  Rates rates;
  Pair start;
  double length;
  double proportional = 0, constant = 0;
  int digits = 15;
  std::uint64_t seed = 1;
  int rows = 150;

  std::string csv() const {
    constexpr int steps = 100;
    double const h = length / (rows - 1) / steps;
    std::vector<Pair> motion = {start};
    Pair at = start;
    auto const plus = [](Pair const& a, double by, Pair const& b) { return Pair{a[0] + by * b[0], a[1] + by * b[1]}; };
    while (std::ssize(motion) < rows) {
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

  json found(std::string const& terms) const { return answer(terms).at("discovery").at("judged").at("structures").at(0); }

  /// Whether a discovery has a finding.
  bool finds(std::string const& terms, std::string const& code) const { return has(answer(terms), code); }

  /// The same of x'' where x alone is measured.
  bool finds_by_displacement(std::string const& terms, std::string const& code) const {
    return has(run("state x = x\ntarget = x''\nterms = " + terms, "measure x = x"), code);
  }

  static bool has(json const& summary, std::string const& code) {
    return std::any_of(summary.at("findings").begin(), summary.at("findings").end(),
                       [&](json const& each) { return each.at("code") == code; });
  }

  json answer(std::string const& terms) const {
    return run("state x = x, y = y\ntarget = x', y'\nterms = " + terms, "measure x = x; measure y = y");
  }

  json run(std::string const& dictionary, std::string const& measured) const {
    std::string const text = "dictionary d {\n" + dictionary + "\n}\ndata record { file \"record.csv\"; time t; " + measured +
                             " }\nfound = discover d from record with seed = 1\n";
    DiscoveryAnswer const answer = run_with(text, {{"record.csv", csv()}});
    REQUIRE_MESSAGE(answer.summary.contains("discovery"), answer.said);
    return answer.summary;
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

TEST_CASE("an equation that terms of the dictionary only imitate is warned of, and not when its terms are offered") {
  // Morse's potential, as powers, sin and cos imitate it.
  Rates const morse = [](Pair const& s) { return Pair{s[1], -0.1 * s[1] - 2 * std::exp(-s[0]) * (1 - std::exp(-s[0]))}; };
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Trial const record{.rates = morse, .start = {1.2, 0}, .length = 20, .proportional = 0.01, .seed = seed};
    CHECK(record.finds(narrow, "other_terms_fit"));
    CHECK_FALSE(record.finds(narrow + ", exp(-x), exp(-2*x)", "other_terms_fit"));
    Trial const prey{.rates = hunting, .start = {4, 1.5}, .length = 12, .proportional = 0.01, .seed = seed};
    CHECK_FALSE(prey.finds(narrow, "other_terms_fit"));
  }
}

TEST_CASE("an equation that is only imitated is warned of where a displacement alone is measured") {
  // A self-excited oscillator whose damping changes sign as the fourth power, under a dictionary to the third.
  Rates const excited = [](Pair const& s) { return Pair{s[1], 0.5 * s[1] * (1 - std::pow(s[0], 4)) - s[0]}; };
  Rates const van_der_pol = [](Pair const& s) { return Pair{s[1], 0.5 * s[1] * (1 - s[0] * s[0]) - s[0]}; };
  std::string const cubic = "1, polynomial(x, x', degree = 3)";
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Trial record{.rates = excited, .start = {0.3, 0}, .length = 40, .constant = 0.04, .seed = seed, .rows = 400};
    CHECK(record.finds_by_displacement(cubic, "other_terms_fit"));
    CHECK_FALSE(record.finds_by_displacement(cubic + ", x^4*x'", "other_terms_fit"));
    record.rates = van_der_pol;
    CHECK_FALSE(record.finds_by_displacement(cubic, "other_terms_fit"));
  }
}

TEST_CASE("the rounding of an input, which moves all samples after it, brings in no term") {
  // Duffing's oscillator under two sines, 300 samples; the input is interpolated before it is rounded.
  constexpr int rows = 300, steps = 20;
  constexpr double h = 0.2 / steps;
  auto const force = [](double t) { return 0.8 * std::sin(0.9 * t) + 0.5 * std::sin(2.3 * t + 0.4); };
  Pair at = {0.5, 0};
  std::string text = "t,u,x,v\n";
  for (int i = 0; i < rows; ++i) {
    double const here = force(0.2 * i), next = force(0.2 * (i + 1));
    text += fmt::format("{:.7g},{:.7g},{:.7g},{:.7g}\n", 0.2 * i, here, at[0], at[1]);
    auto const rates = [&](Pair const& s, double part) {
      return Pair{s[1], here + (next - here) * part - 0.2 * s[1] - s[0] - 0.5 * s[0] * s[0] * s[0]};
    };
    auto const plus = [](Pair const& a, double by, Pair const& b) { return Pair{a[0] + by * b[0], a[1] + by * b[1]}; };
    for (int k = 0; k < steps; ++k) {
      double const begin = static_cast<double>(k) / steps, middle = begin + 0.5 / steps, end = begin + 1.0 / steps;
      Pair const k1 = rates(at, begin), k2 = rates(plus(at, h / 2, k1), middle), k3 = rates(plus(at, h / 2, k2), middle),
                 k4 = rates(plus(at, h, k3), end);
      for (std::size_t s = 0; s < 2; ++s) at[s] += h / 6 * (k1[s] + 2 * k2[s] + 2 * k3[s] + k4[s]);
    }
  }
  std::string const file =
      "dictionary d {\ninput u\nstate x = x, v = v\ntarget = x', v'\nterms = polynomial(x, v, degree = 3), 1, sin(x), cos(x), "
      "sin(v), cos(v), u, u*x, u*v\n}\n"
      "data record { file \"record.csv\"; time t; input u = u hold linear; measure x = x; measure v = v }\n"
      "found = discover d from record with seed = 1\n";
  DiscoveryAnswer const answer = run_with(file, {{"record.csv", text}});
  json const first = answer.summary.at("discovery").at("judged").at("structures").at(0);
  CHECK(first.at("terms") == "x': v; v': x, v, x^3, u");
  for (json const& each : answer.summary.at("findings")) CHECK(each.at("severity") == "note");
}
