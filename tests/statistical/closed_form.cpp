// A linear model with Gaussian priors and known noise: the posterior is a known Gaussian.
#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "fits.hpp"
#include "relative.hpp"

using namespace sysid;

TEST_CASE("posterior means within 3 MCSE and sds within 5 % of the closed form at an effective sample size of 2000") {
  // y' = a + b x with x held: y_i is linear in a and b, exactly so under Runge-Kutta.
  int const n = 60;
  double const step = 0.1, noise = 0.3, prior_sd = 2;
  Stream stream({11, Purpose::test, 0, 0});
  std::string csv = "t,x,y\n";
  double sa = 0, sb = 0;  // regressors: dy/da, dy/db
  double p00 = 1 / (prior_sd * prior_sd), p01 = 0, p11 = p00, q0 = 0, q1 = 0;
  for (int i = 0; i < n; ++i) {
    double const x = stream.normal(), y = 0.7 * sa - 1.2 * sb + noise * stream.normal();
    csv += shortest(i * step) + "," + shortest(x) + "," + shortest(y) + "\n";
    double const w = 1 / (noise * noise);
    p00 += w * sa * sa;
    p01 += w * sa * sb;
    p11 += w * sb * sb;
    q0 += w * sa * y;
    q1 += w * sb * y;
    sa += step;
    sb += step * x;
  }
  double const determinant = p00 * p11 - p01 * p01;
  double const mean_a = (p11 * q0 - p01 * q1) / determinant, mean_b = (p00 * q1 - p01 * q0) / determinant;
  double const sd_a = std::sqrt(p11 / determinant), sd_b = std::sqrt(p00 / determinant);
  std::string const text = R"(
model drift {
  input x
  state y
  initial y = 0
  parameter a ~ normal(0, sd = 2)
  parameter b ~ normal(0, sd = 2)
  y' = a + b*x
  observe level ~ normal(y, sd = 0.3)
}
data record {
  file "record.csv"
  time t [s]
  input x = x hold zero_order
  measure level = y
}
posterior = fit drift to record with mh(samples = 30000, burn_in = 5000, thin = 5), seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"record.csv", csv}});
  CHECK(fitted.exit == 0);
  for (auto const& [name, mean, sd] : {std::tuple{"a", mean_a, sd_a}, {"b", mean_b, sd_b}}) {
    auto const& found = fitted.of("posterior", name);
    CHECK(found.at("ess_bulk").get<double>() >= 2000);
    CHECK(std::abs(found.at("mean").get<double>() - mean) <= 3 * found.at("mcse_mean").get<double>());
    CHECK(found.at("sd").get<double>() == relative(sd, 0.05));
  }
}
