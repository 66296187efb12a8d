// Records of some hundred periods, on which a search of the whole record ends in one of many optima.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

struct Spring {
  double c, k, k3, force, noise;  // sd of the force [N]; of the noise, in sds of the response
  int rows, substeps;
  double step;  // s
};

/// y'' + c y' + k y + k3 y^3 = u for forces that are held for four samples each, by Runge-Kutta steps.
std::string hardening_record(std::uint64_t key, Spring const& of) {
  using State = std::array<double, 2>;
  Stream stream({key, Purpose::test, 0, 0});
  int const rows = of.rows, substeps = of.substeps;
  double const step = of.step, h = step / substeps;
  double u = 0;
  auto const rate = [&](State const& x) { return State{x[1], u - of.c * x[1] - of.k * x[0] - of.k3 * x[0] * x[0] * x[0]}; };
  auto const moved = [](State const& x, double by, State const& r) { return State{x[0] + by * r[0], x[1] + by * r[1]}; };
  State x{0, 0};
  std::vector<double> force, response;
  double square = 0;
  for (int i = 0; i < rows; ++i) {
    if (i % 4 == 0) u = of.force * stream.normal();
    force.push_back(u);
    response.push_back(x[0]);
    square += x[0] * x[0];
    for (int k = 0; k < substeps; ++k) {
      State const a = rate(x), b = rate(moved(x, h / 2, a)), c = rate(moved(x, h / 2, b)), d = rate(moved(x, h, c));
      for (std::size_t s = 0; s < 2; ++s) x[s] += h / 6 * (a[s] + 2 * b[s] + 2 * c[s] + d[s]);
    }
  }
  double const noise = of.noise * std::sqrt(square / rows);
  std::string table = "t,u,y\n";
  for (int i = 0; i < rows; ++i) {
    auto const at = static_cast<std::size_t>(i);
    table += fmt::format("{:.2f},{:.6g},{:.9g}\n", step * i, force[at], response[at] + noise * stream.normal());
  }
  return table;
}

}  // namespace

TEST_CASE("a hardening spring under a random force is found from priors of two to four decades, whatever the seed") {
  std::string const model =
      "model spring {\n  input u [N]\n  state y [m]\n  initial y = 0, y' = 0\n  parameter m [kg] ~ log_uniform(0.1, 10)\n"
      "  parameter c [N s/m] ~ log_uniform(0.1, 100)\n  parameter k [N/m] ~ log_uniform(10, 1e4)\n"
      "  parameter k3 [N/m^3] ~ log_uniform(1e3, 1e7)\n  parameter sigma [m] ~ log_uniform(1e-7, 1)\n"
      "  m*y'' + c*y' + k*y + k3*y^3 = u\n  observe d ~ normal(y, sd = sigma)\n}\n"
      "data record { file \"record.csv\"; time t [s]; input u = u hold zero_order; measure d = y }\n";
  for (std::uint64_t const key : {33, 34}) {
    std::string const table = hardening_record(key, {2, 400, 3e5, 7, 0.01, 1600, 4, 0.01});
    for (int const seed : {1, 2}) {
      CAPTURE(key);
      CAPTURE(seed);
      json const summary =
          CaseRun(model + fmt::format("best = fit spring to record with map, seed = {}\n", seed), {{"record.csv", table}})
              .summary("best");
      for (auto const& [name, truth] : {std::pair("m", 1.0), std::pair("c", 2.0), std::pair("k", 400.0), std::pair("k3", 3e5)}) {
        json const& found = summary.at("parameters").at(name);
        CHECK(std::fabs(found.at("mean").get<double>() - truth) < 5 * found.at("sd").get<double>());
      }
      CHECK(summary.at("findings").empty());
    }
  }
}

TEST_CASE("a short record of a spring that is mostly cubic is found from priors of four to eight decades") {
  std::string const model =
      "model spring {\n  input u [N]\n  state y [m]\n  initial y = 0, y' = 0\n  parameter c [N s/m] ~ log_uniform(0.01, 100)\n"
      "  parameter k [N/m] ~ log_uniform(1, 1e5)\n  parameter k3 [N/m^3] ~ log_uniform(1, 1e8)\n"
      "  parameter sigma [m] ~ log_uniform(1e-8, 10)\n  1 [kg]*y'' + c*y' + k*y + k3*y^3 = u\n"
      "  observe d ~ normal(y, sd = sigma)\n}\n"
      "data record { file \"record.csv\"; time t [s]; input u = u hold zero_order; measure d = y }\n";
  // One of these records is nearly chaotic: a place beside the optimum is not the worst that can happen, as long as it is told.
  int in_place = 0;
  for (std::uint64_t const key : {1, 2, 3}) {
    std::string const table = hardening_record(key, {0.8, 60, 5e4, 10, 0.05, 600, 20, 0.02});
    for (int const seed : {1, 2}) {
      CAPTURE(key);
      CAPTURE(seed);
      json const summary =
          CaseRun(model + fmt::format("best = fit spring to record with ml, seed = {}\n", seed), {{"record.csv", table}})
              .summary("best");
      bool right = true;
      for (auto const& [name, truth] : {std::pair("c", 0.8), std::pair("k", 60.0), std::pair("k3", 5e4)}) {
        json const& found = summary.at("parameters").at(name);
        right = right && std::fabs(found.at("mean").get<double>() - truth) < 4 * found.at("sd").get<double>();
      }
      in_place += right ? 1 : 0;
      CHECK((right || !summary.at("findings").empty()));
    }
  }
  CHECK(in_place >= 4);
}
