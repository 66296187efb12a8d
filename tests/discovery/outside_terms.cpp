// Difference equations whose dictionary lacks what the record has, and others that only their noise sets apart from it.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "discovery/discovering.hpp"

using namespace sysid;
using namespace sysid::test;
using json = nlohmann::json;

namespace {

/// y_i = 0.6 y_(i-1) + of(y_(i-1), u_(i-1)) + errors; measured with noise; u white.
std::string difference_record(std::function<double(double y, double u)> const& of, double error, double noise, std::uint64_t seed) {
  Stream force({seed, Purpose::input, 0, 0}), own({seed, Purpose::noise, 0, 0}), sensor({seed, Purpose::noise, 1, 0});
  std::string table = "u,y\n";
  double y = 0, u = 0;
  for (int i = 0; i < 500; ++i) {
    y = 0.6 * y + of(y, u) + error * own.normal();
    u = force.normal();
    table += fmt::format("{:.10g},{:.10g}\n", u, y + noise * sensor.normal());
  }
  return table;
}

json other_terms_of(std::string const& table, int degree = 3) {
  std::string const text = fmt::format(
      "dictionary narx {{\n time discrete\n input u\n state y = position\n target = y\n terms = 1, polynomial(lags(y, 1..2), "
      "lags(u, 1..2), degree = {})\n}}\ndata bench {{ file \"bench.csv\"; rate 1 [Hz]; input u = u; measure position = y }}\n"
      "found = discover narx from bench with seed = 1\n",
      degree);
  return run_with(text, {{"bench.csv", table}}).finding("other_terms_fit");
}

}  // namespace

TEST_CASE("what a dictionary lacks is missed although white inputs leave white residuals") {
  auto const missed = [](std::function<double(double, double)> const& of, double error, int degree = 3) {
    json const found = other_terms_of(difference_record(of, error, 0, 3), degree);
    REQUIRE_FALSE(found.is_null());
    CHECK(found.at("severity") == "warning");
    CHECK_MESSAGE(contains(found.at("message"), "lag(u, 1)"), found.dump());
  };
  missed([](double, double u) { return 0.8 * std::tanh(2 * u); }, 0);
  missed([](double, double u) { return 0.8 * std::tanh(2 * u); }, 0.05);
  missed([](double, double u) { return 0.5 * std::sin(2.5 * u); }, 0.05);
  missed([](double, double u) { return u > 0.5 ? u - 0.5 : u < -0.5 ? u + 0.5 : 0; }, 0.05);
  missed([](double, double u) { return 0.4 * u - 0.1 * u * u * u * u; }, 0.05, 2);
}

TEST_CASE("equations of the dictionary are not doubted, with errors of their own, of the sensor, or of the file") {
  auto const polynomial = [](double y, double u) { return 0.9 * u - 0.1 * u * u * u + 0.05 * y * y * u; };
  for (auto const& [error, noise] : {std::pair(0.0, 0.0), std::pair(0.05, 0.0), std::pair(0.2, 0.0), std::pair(0.0, 0.05)})
    for (std::uint64_t const seed : {1, 2, 3}) {
      CAPTURE(error);
      CAPTURE(noise);
      CAPTURE(seed);
      json const found = other_terms_of(difference_record(polynomial, error, noise, seed));
      CHECK_MESSAGE(found.is_null(), found.dump());
    }
}
