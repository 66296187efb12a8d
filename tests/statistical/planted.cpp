// Each diagnostic on a case where it must fire and on a sound one where it must be silent.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "fits.hpp"

using namespace sysid;

namespace {

std::string sound() { return with(with(duffing_text(), "forecast  =", "# forecast ="), "truth     =", "truth ="); }

Fitted const& sound_fit() {
  static Fitted const fitted = run_file(sound(), seeded(7));
  return fitted;
}

}  // namespace

TEST_CASE("a sound fit raises no finding") {
  CHECK(sound_fit().exit == 0);
  CHECK(sound_fit().summary.at("posterior").at("findings").empty());
}

TEST_CASE("an input held in the record but interpolated in the fit has its rule named") {
  // The generator holds the force; a straight line between its samples acts half a sample earlier.
  Fitted const fitted = run_file(with(sound(), "hold zero_order", "hold linear"), seeded(7));
  CHECK(fitted.found("posterior", "input_rule"));
  CHECK_FALSE(fitted.found("posterior", "input_timing"));
  CHECK_FALSE(sound_fit().found("posterior", "input_rule"));
}

TEST_CASE("a prior that ends below the truth raises the bound warning") {
  Fitted const fitted = run_file(with(sound(), "log_uniform(2, 200)", "log_uniform(2, 19.9)"), seeded(7));
  CHECK(fitted.found("posterior", "piles_up_at_bound"));
  CHECK_FALSE(sound_fit().found("posterior", "piles_up_at_bound"));
}

TEST_CASE("two solutions raise the mode warning") {
  // Only the square of the stiffness acts, so both signs of its root are solutions.
  std::string const text = R"(
model linear {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter w [rad/s] ~ normal(0, sd = 100)
  constant m [kg] = 1
  parameter sigma [m] ~ log_uniform(1e-8, 1e-3)
  m*y'' + c*y' + m*w^2*y = x
  observe displacement ~ normal(y, sd = sigma)
}
data bench {
  file "results/truth/data.csv"
  time t [s]
  input x = x [N] hold zero_order
  measure displacement = displacement [m]
}
truth = simulate linear with values(c = 20, w = 100), input x = gaussian(sd = 10), noise = 1 [percent], samples = 300, rate = 1000 [Hz], file = "data.csv"
posterior = fit linear to bench with mh(samples = 6000, burn_in = 3000, thin = 2)
)";
  Fitted const walks = run_file(with(text, "thin = 2", "thin = 2, proposal = walk"), seeded(3));
  CHECK(walks.found("posterior", "second_mode"));
  CHECK(walks.exit == 1);  // chains in different modes disagree, and no start hides that
  // Independence moves cross, so the chains agree, on both modes: the warning is what is left.
  Fitted const fitted = run_file(text, seeded(3));
  CHECK(fitted.found("posterior", "second_mode"));
  CHECK(fitted.exit == 0);
  CHECK_FALSE(sound_fit().found("posterior", "second_mode"));
}

TEST_CASE("a model without the cubic spring leaves coloured residuals") {
  std::string text = sound();
  text = with(text, "+ k3*y^3 = x", "= x + 0*k3*y^3");
  // The data still come from the full model, which a second model of the file makes.
  std::string const full =
      "model full {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n 1 [kg]*y'' + 20 [N s/m]*y' + 1e4 [N/m]*y + 5e10 "
      "[N/m^3]*y^3 = x\n"
      " observe displacement ~ normal(y, sd = 1e-9)\n}\n";
  text = with(full + text, "simulate duffing\n    with values(m = 1, c = 20, k = 1e4, k3 = 5e9),", "simulate full\n    with");
  Fitted const fitted = run_file(text, seeded(7));
  CHECK(fitted.found("posterior", "residuals_not_white"));
  CHECK_FALSE(sound_fit().found("posterior", "residuals_not_white"));
}

TEST_CASE("one step a sample at a coarse rate raises the tolerance guard, the chosen number does not") {
  std::string text = with(sound(), "rate = 1000 [Hz]", "rate = 150 [Hz], substeps = 40");
  Fitted const coarse = run_file(with(text, "chains = 4)", "chains = 4), substeps = 1"), seeded(7));
  CHECK(coarse.found("posterior", "integration_step"));
  CHECK(coarse.exit == 1);
  Fitted const settled = run_file(text, seeded(7));
  CHECK_FALSE(settled.found("posterior", "integration_step"));
  CHECK(settled.summary.at("posterior").at("settings").at("substeps").get<int>() > 1);
}

TEST_CASE("noise stated too small is told from noise stated right") {
  std::string const wrong = with(sound(), "parameter beta [1/m^2] ~ log_uniform(1e8, 1e13)", "parameter beta [1/m^2] = 1e13");
  CHECK(run_file(wrong, seeded(7)).found("posterior", "noise_size"));
  CHECK_FALSE(sound_fit().found("posterior", "noise_size"));
}
