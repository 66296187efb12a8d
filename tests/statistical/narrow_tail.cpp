// A posterior that narrows into a tail which no chain enters by itself in burn-in: a hierarchy of two groups as printed, with the
// spread times standard normal members, against quadrature over the spread.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "fits.hpp"

using namespace sysid;

namespace {

constexpr std::array<std::array<double, 2>, 2> measured = {{{1.602, -0.659}, {1.084, -1.473}}};
constexpr double mean_sd = 10;

struct Spread {
  double mean, q95;
};

/// Of tau ~ half-Cauchy(1), where group j is measured as N(mu + tau z_j, 1), z_j ~ N(0, 1), mu ~ N(0, 10^2): given tau the means of
/// the groups are normal, and mu is integrated out in closed form.
Spread exact_spread() {
  double sum = 0, moment = 0;
  std::vector<std::array<double, 2>> weighted_values;
  for (int i = 0; i <= 4000; ++i) {
    double const log_tau = std::log(1e-4) + i * std::log(1e8) / 4000, tau = std::exp(log_tau);
    double const variance = 0.5 + tau * tau;
    double precision = 1 / (mean_sd * mean_sd), weighted = 0, log_density = 0;
    for (auto const& group : measured) {
      double const mean = (group[0] + group[1]) / 2;
      precision += 1 / variance;
      weighted += mean / variance;
      log_density -= 0.5 * std::log(variance) + 0.5 * mean * mean / variance;
    }
    log_density += 0.5 * weighted * weighted / precision - 0.5 * std::log(precision);
    double const weight = std::exp(log_density) / (1 + tau * tau) * tau;  // of log tau
    sum += weight;
    moment += weight * tau;
    weighted_values.push_back({tau, weight});
  }
  double below = 0;
  std::size_t at = 0;
  while (below < 0.95 * sum) below += weighted_values[at++][1];
  return {moment / sum, weighted_values[at - 1][0]};
}

}  // namespace

TEST_CASE("chains reach a tail that narrows so much that none enters it by itself in burn-in") {
  std::string data = "group,y\n";
  for (std::size_t group = 0; group < 2; ++group)
    for (double const y : measured[group]) data += std::to_string(group) + "," + std::to_string(y) + "\n";
  std::string text =
      "model m {\n  input group\n  parameter mu ~ normal(0, sd = 10)\n  parameter tau ~ half_cauchy(1)\n"
      "  parameter z0 ~ normal(0, sd = 1)\n  parameter z1 ~ normal(0, sd = 1)\n"
      "  observe y ~ normal(mu + tau*piecewise(group < 0.5, z0, z1), sd = 1)\n}\n"
      "data d { file \"d.csv\"; input group = group; measure y = y }\n";
  for (int const seed : {1, 2})
    text += "f" + std::to_string(seed) + " = fit m to d with mh(samples = 15000), seed = " + std::to_string(seed) + "\n";
  Fitted const fitted = run_file(text, {}, {{"d.csv", data}});
  Spread const exact = exact_spread();
  CHECK(exact.mean == doctest::Approx(0.903).epsilon(0.01));
  for (auto const& [name, summary] : fitted.summary) {
    CAPTURE(name);
    nlohmann::json const& tau = fitted.of(name, "tau");
    CHECK(std::abs(tau.at("mean").get<double>() - exact.mean) < 4 * tau.at("mcse_mean").get<double>());
    CHECK(tau.at("ess_tail").get<double>() > 1000);
    CHECK(tau.at("q95").get<double>() > 0.94 * exact.q95);  // 0.89 of it without the tail
  }
  CHECK(fitted.summary.size() == 2);
}
