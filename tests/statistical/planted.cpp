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

TEST_CASE("two columns that have changed places are named with the lines that change them back") {
  std::string const right = sound();
  std::string wrong = with(right, "input   x = x [N]", "input   x = displacement [N]");
  wrong = with(wrong, "measure displacement = displacement [m]", "measure displacement = x [m]");
  wrong = with(wrong, "with mh(samples = 5000, burn_in = 1500, thin = 5, chains = 4)", "with map");
  Fitted const fitted = run_file(wrong, seeded(7));
  CHECK(fitted.found("posterior", "column_used_twice"));
  CHECK(fitted.out.find("if so, write `input x = x [N] hold zero_order` and `measure displacement = displacement [m]`") !=
        std::string::npos);
}

TEST_CASE("an input with the wrong sign is named, and so is one of two channels; neither of what the model lacks") {
  std::string table = "t,f,y,v\n", reversed = table, disturbed = table;
  Stream stream({21, Purpose::test, 0, 0});
  for (int i = 0; i < 300; ++i) {  // y'' + 2 y' + 100 y = 100 cos(7 t), in its steady state
    double const t = 0.02 * i, gain = 100 / std::hypot(51, 14), lag = std::atan2(14, 51), phase = 7 * t - lag;
    double const y = gain * std::cos(phase) + 0.01 * stream.normal(), v = -7 * gain * std::sin(phase) + 0.05 * stream.normal();
    table += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", t, 100 * std::cos(7 * t), y, v);
    reversed += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", t, 100 * std::cos(7 * t), y, -v);
    disturbed +=
        fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", t, 100 * std::cos(7 * t), y + std::sin(2 * t), v + 7 * std::sin(2 * t));
  }
  std::string const both = R"(
model rig {
  input f [N]
  state y [m]
  parameter y0 [m] ~ normal(0, sd = 2)
  parameter v0 [m/s] ~ normal(0, sd = 20)
  initial y = y0, y' = v0
  parameter c [N s/m] ~ log_uniform(0.1, 100)
  parameter k [N/m] ~ log_uniform(1, 1000)
  1 [kg]*y'' + c*y' + k*y = f
  observe position ~ normal(y, sd = 0.01 [m])
  observe velocity ~ normal(y', sd = 0.05 [m/s])
}
data rec { file "rec.csv"; time t [s]; input f = f [N] hold cubic; measure position = y [m]; measure velocity = v [m/s] }
post = fit rig to rec with map, seed = 1
)";
  CHECK_FALSE(run_file(both, {}, {{"rec.csv", table}}).found("post", "sign_reversed"));
  Fitted const force = run_file(with(both, "= f\n", "= -f\n"), {}, {{"rec.csv", table}});
  CHECK(force.found("post", "sign_reversed"));
  CHECK(force.out.find("if the file is right, write `-f` in place of `f`") != std::string::npos);
  Fitted const velocity = run_file(both, {}, {{"rec.csv", reversed}});
  CHECK(velocity.found("post", "sign_reversed"));
  CHECK(velocity.out.find("with the sign of column `v` of rec reversed") != std::string::npos);
  CHECK_FALSE(run_file(both, {}, {{"rec.csv", disturbed}}).found("post", "sign_reversed"));
  // In both blocks of a fit; and the second channel of a block is of another model.
  std::string const two =
      with(with(with(both, "= f\n", "= -f\n"), "post = fit rig to rec", "post = fit rig to rec, again"), "data rec {",
           "data again { file \"again.csv\"; time t [s]; input f = f [N] hold cubic; "
           "measure position = y [m]; measure velocity = v [m/s] }\ndata rec {");
  Fitted const twice = run_file(two, {}, {{"rec.csv", table}, {"again.csv", table}});
  CHECK(twice.out.find("with the sign of column `f` of rec and again reversed") != std::string::npos);
  std::string const other = with(with(both, "= f\n", "= -f\n"), "  observe velocity ~ normal(y', sd = 0.05 [m/s])\n", "") +
                            "model second { input f [N]; state z [m]; initial z = 0; parameter r [1/s] ~ log_uniform(0.1, 10)\n"
                            " z' = -r*z; observe velocity ~ normal(z', sd = 1) }\n";
  CHECK(run_file(other, {}, {{"rec.csv", table}}).found("post", "sign_reversed"));
}

TEST_CASE("two inputs that have changed places are named, and none of a record whose motion the model lacks in part") {
  std::string table = "minutes,power,ambient,temp\n", disturbed = table;
  double temperature = 21;
  Stream stream({5, Purpose::test, 0, 0});
  for (int i = 0; i < 200; ++i) {
    double const power = i % 37 < 18 ? 120 : 20, ambient = 21 + 3 * std::sin(0.045 * i), noise = 0.05 * stream.normal();
    std::string const row = fmt::format("{},{},{:.5g},", i, power, ambient);
    table += row + fmt::format("{:.5g}\n", temperature + noise);
    disturbed += row + fmt::format("{:.5g}\n", temperature + noise + 2.5 * std::sin(0.31 * i));
    double const rest = ambient + 0.7 * power;  // C = 4.2 kJ/K, R = 0.7 K/W
    temperature = rest + (temperature - rest) * std::exp(-60 / (4200 * 0.7));
  }
  std::string const right = R"(
model oven {
  input P [W], Ta [degC]
  state T [degC]
  initial T = 21 [degC]
  parameter C [kJ/K] ~ log_uniform(0.5, 50)
  parameter R [K/W] ~ log_uniform(0.05, 20)
  parameter sigma [K] ~ log_uniform(0.001, 10)
  C*T' = P - (T - Ta)/R
  observe temperature ~ normal(T, sd = sigma)
}
data day {
  file "oven.csv"
  time minutes [min]
  input P = power [W] hold zero_order
  input Ta = ambient [degC] hold zero_order
  measure temperature = temp [degC]
}
warm = fit oven to day with map, seed = 1
)";
  std::string const wrong = with(with(right, "P = power", "P = ambient"), "Ta = ambient", "Ta = power");
  Fitted const exchanged = run_file(wrong, {}, {{"oven.csv", table}});
  CHECK(exchanged.found("warm", "column_used_twice"));
  CHECK(exchanged.out.find(
            "if they are exchanged, write `input P = power [W] hold zero_order` and `input Ta = ambient [degC] hold zero_order`") !=
        std::string::npos);
  CHECK_FALSE(run_file(right, {}, {{"oven.csv", table}}).found("warm", "column_used_twice"));
  Fitted const lacking = run_file(right, {}, {{"oven.csv", disturbed}});
  CHECK(lacking.found("warm", "residuals_not_white"));
  CHECK_FALSE(lacking.found("warm", "column_used_twice"));
}

TEST_CASE("the columns of a step response are found exchanged: a step is no sinusoid") {
  std::string table = "t,u,y\n";
  Stream stream({15, Purpose::test, 0, 0});
  for (int i = 0; i < 200; ++i) {
    double const t = 0.1 * i, u = i < 20 ? 0 : 1;
    table += fmt::format("{:.6g},{},{:.6g}\n", t, u, (i < 20 ? 0 : 2 * (1 - std::exp(-0.5 * (t - 2)))) + 0.01 * stream.normal());
  }
  std::string const wrong = R"(
model lag1 {
  input u [V]
  state y [V]
  initial y = 0
  parameter r [1/s] ~ log_uniform(0.01, 10)
  parameter g [-] ~ log_uniform(0.1, 10)
  parameter sigma [V] ~ log_uniform(0.001, 10)
  y' = r*(g*u - y)
  observe out ~ normal(y, sd = sigma)
}
data rec { file "rec.csv"; time t [s]; input u = y [V] hold zero_order; measure out = u [V] }
post = fit lag1 to rec with map, seed = 1
)";
  CHECK(run_file(wrong, {}, {{"rec.csv", table}}).found("post", "column_used_twice"));
  std::string const right = with(with(wrong, "input u = y [V]", "input u = u [V]"), "measure out = u", "measure out = y");
  CHECK_FALSE(run_file(right, {}, {{"rec.csv", table}}).found("post", "column_used_twice"));
}

TEST_CASE("a model that predicts from measured samples is not tried with exchanged columns") {
  // The input is smooth, so that its own past predicts it; the output has a memory of two samples, which the model lacks.
  std::string table = "u,y\n";
  Stream stream({12, Purpose::test, 0, 0});
  double before = 0, now = 0;
  for (int i = 0; i < 400; ++i) {
    double const u = std::sin(0.11 * i) + 0.7 * std::sin(0.047 * i + 1) + 0.4 * std::sin(0.171 * i + 2);
    double const next = 0.2 * now - 0.7 * before + 0.3 * u + 0.2 * stream.normal();
    before = now;
    now = next;
    table += fmt::format("{:.6g},{:.6g}\n", u, now);
  }
  std::string const text = R"(
model arx {
  time discrete
  input u
  parameter a ~ uniform(-2, 2)
  parameter b ~ normal(0, sd = 1)
  parameter sigma ~ log_uniform(1e-3, 10)
  observe output ~ normal(a*lag(measured(output), 1) + b*lag(u, 1), sd = sigma)
}
data rec { file "rec.csv"; rate 1 [Hz]; input u = u; measure output = y }
post = fit arx to rec with map, seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"rec.csv", table}});
  CHECK(fitted.found("post", "residuals_not_white"));
  CHECK_FALSE(fitted.found("post", "column_used_twice"));
}

TEST_CASE("columns are not taken for exchanged because an oscillator that is hardly damped moves as any sinusoid") {
  // What moves the mass is not in the record; the force that is would be its free motion.
  std::string table = "t,x,y\n";
  Stream stream({13, Purpose::test, 0, 0});
  for (int i = 0; i < 500; ++i) {
    double const t = 0.02 * i;
    table += fmt::format("{:.6g},{:.6g},{:.6g}\n", t, std::sin(5 * t),
                         std::sin(2.5 * t - 0.4) + 0.3 * std::sin(1.3 * t) + 0.001 * stream.normal());
  }
  std::string const text = R"(
model oscillator {
  input x [N]
  state y [m]
  parameter m [kg] ~ log_uniform(0.1, 10000)
  parameter c [N s/m] ~ log_uniform(1e-3, 100)
  parameter k [N/m] ~ log_uniform(1, 1e6)
  parameter y0 [m] ~ normal(0, sd = 2)
  parameter v0 [m/s] ~ normal(0, sd = 10)
  parameter sigma [m] ~ log_uniform(1e-4, 1)
  initial y = y0, y' = v0
  m*y'' + c*y' + k*y = x
  observe position ~ normal(y, sd = sigma)
}
data rec { file "rec.csv"; time t [s]; input x = x [N] hold linear; measure position = y [m] }
post = fit oscillator to rec with map, seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"rec.csv", table}});
  CHECK(fitted.found("post", "residuals_not_white"));
  CHECK_FALSE(fitted.found("post", "column_used_twice"));
}

TEST_CASE("a parameter that `start` replaces is named once") {
  std::string table = "t,u,y\n";
  Stream stream({14, Purpose::test, 0, 0});
  double level = 0;
  for (int i = 0; i < 120; ++i) {
    double const u = i % 23 < 11 ? 2 : -1;
    table += fmt::format("{},{},{:.6g}\n", 0.1 * i, u, level + 0.02 * stream.normal());
    level = u + (level - u) * std::exp(-0.15);
  }
  std::string const text = R"(
model lag1 {
  input u [V]
  state y [V]
  parameter r [1/s] ~ log_uniform(0.05, 50)
  parameter y0 [V] ~ normal(0, sd = 1)
  parameter sigma [V] ~ log_uniform(0.001, 10)
  initial y = y0
  y' = r*(u - y)
  observe out ~ normal(y, sd = sigma)
}
data rec { file "rec.csv"; time t [s]; input u = u [V] hold zero_order; measure out = y [V] }
post = fit lag1 to rec with mh(samples = 6000, burn_in = 2000, thin = 4), start = rest, seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"rec.csv", table}});
  CHECK(fitted.found("post", "unused_parameter"));
  CHECK_FALSE(fitted.found("post", "flat_direction"));
}

TEST_CASE("a parameter that the likelihood does not contain in its prior's range is named by a sampler too") {
  std::string table = "t,u,y\n";
  for (int i = 0; i < 80; ++i) {
    double const u = i % 9 < 5 ? 0.8 : -0.4;
    table += fmt::format("{},{},{:.6g}\n", 0.1 * i, u, 0.5 * u + 0.02 * ((i * 37) % 11 - 5));
  }
  std::string const text = R"(
model zone {
  input u [V]
  parameter g [-] ~ normal(0, sd = 2)
  parameter edge [V] ~ uniform(-5, -0.9)
  parameter sigma [V] ~ log_uniform(0.001, 10)
  observe out [V] ~ normal(g*max(u, edge), sd = sigma)
}
data rec { file "rec.csv"; input u = u [V]; measure out = y [V] }
post = fit zone to rec with mh(samples = 6000, burn_in = 2000, thin = 4), seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"rec.csv", table}});
  CHECK(fitted.found("post", "flat_direction"));
  CHECK(fitted.out.find("the data do not determine edge: the likelihood does not depend on it") != std::string::npos);
  CHECK(fitted.out.find("determine g") == std::string::npos);
  CHECK_FALSE(
      run_file(with(text, "uniform(-5, -0.9)", "uniform(-5, 0.5)"), {}, {{"rec.csv", table}}).found("post", "flat_direction"));
}

TEST_CASE("a moment of switching that the rows leave free within one interval is not taken for a parameter without influence") {
  std::string table = "x,y\n";
  for (int i = 0; i < 60; ++i) table += fmt::format("{},{:.6g}\n", i, (i > 40 ? 2.0 : 0.5) + 0.02 * ((i * 37) % 11 - 5));
  std::string const text = R"(
model step {
  input x [-]
  parameter low [V] ~ normal(0, sd = 5)
  parameter high [V] ~ normal(0, sd = 5)
  parameter moment [-] ~ uniform(30, 50)
  parameter sigma [V] ~ log_uniform(0.001, 10)
  observe out [V] ~ normal(if x > moment then high else low, sd = sigma)
}
data rec { file "rec.csv"; input x = x; measure out = y [V] }
post = fit step to rec with mh(samples = 6000, burn_in = 2000, thin = 4), seed = 1
)";
  Fitted const fitted = run_file(text, {}, {{"rec.csv", table}});
  CHECK(fitted.of("post", "moment").at("q5").get<double>() > 39);
  CHECK(fitted.of("post", "moment").at("q95").get<double>() < 42);
  CHECK(fitted.out.find("the likelihood does not depend on it") == std::string::npos);
}

TEST_CASE("noise of another law than normal is named, and the line of its help ends the finding") {
  std::string tails = "x,y\n", proportional = tails, plain = tails;
  Stream stream({3, Purpose::test, 0, 0});
  for (int i = 0; i < 200; ++i) {
    double const x = 0.05 * i, y = 2 + 3 * x, noise = stream.normal();
    plain += fmt::format("{},{:.6g}\n", x, y + 0.1 * noise);
    // Each of 200 quantiles of Student's distribution with 4 degrees of freedom once (Shaw 2006, J. Comput. Finance 9, 37).
    double const p = (i * 77 % 200 + 0.5) / 200, alpha = 4 * p * (1 - p);
    double const tail = 2 * std::sqrt(std::cos(std::acos(std::sqrt(alpha)) / 3) / std::sqrt(alpha) - 1);
    tails += fmt::format("{},{:.6g}\n", x, y + 0.1 * (p < 0.5 ? -tail : tail));
    proportional += fmt::format("{},{:.6g}\n", x, y + 0.1 * y * noise);
  }
  std::string const text =
      "model line {\n input x [-]\n parameter a [m] ~ normal(0, sd = 10)\n parameter b [m] ~ normal(0, sd = 10)\n"
      " parameter sigma [m] ~ log_uniform(1e-3, 10)\n observe reading [m] ~ normal(a + b*x, sd = sigma)\n}\n"
      "data rec { file \"rec.csv\"; input x = x; measure reading = y [m] }\npost = fit line to rec with map, seed = 1\n";
  CHECK_FALSE(run_file(text, {}, {{"rec.csv", plain}}).found("post", "noise_law"));
  std::string const observed = "observe reading [m] ~ normal(a + b*x, sd = sigma)";

  Fitted const heavy = run_file(text, {}, {{"rec.csv", tails}});
  CHECK(heavy.found("post", "noise_law"));
  std::string const with_tails = "observe reading [m] ~ student_t(a + b*x, 4, scale = sigma)";
  CHECK(heavy.out.find("`" + with_tails + "`") != std::string::npos);
  CHECK_FALSE(run_file(with(text, observed, with_tails), {}, {{"rec.csv", tails}}).found("post", "noise_law"));

  Fitted const grows = run_file(text, {}, {{"rec.csv", proportional}});
  CHECK(grows.found("post", "noise_law"));
  std::string const parameter = "parameter reading_relative [-] ~ log_uniform(1e-4, 1)",
                    in_part = "observe reading [m] ~ normal(a + b*x, sd = sqrt(sigma^2 + (reading_relative*(a + b*x))^2))";
  CHECK(grows.out.find("add `" + parameter + "` and write `" + in_part + "`") != std::string::npos);
  CHECK_FALSE(
      run_file(with(text, observed, parameter + "\n " + in_part), {}, {{"rec.csv", proportional}}).found("post", "noise_law"));
}
