// Factors of a text that convert what a unit converts, and bare numbers beside angles and shares.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string with(std::string const& statement) {
  return messages(
      "model m {\ninput u [N m]\nstate phi [deg]\ninitial phi = 0, phi' = 0\nparameter J [kg m^2] ~ log_uniform(1e-3, 1)\n"
      "parameter G [N m] ~ log_uniform(0.1, 10)\nparameter loss [percent] ~ uniform(1, 20)\nparameter s [deg] ~ half_normal(sd = "
      "1)\n"
      "parameter f [Hz] ~ log_uniform(0.1, 10)\nJ*phi'' + G*sin(phi) = u\nobserve angle [deg] ~ normal(phi, sd = s)\n"
      "parameter T [s] ~ log_uniform(0.1, 10)\nderive used = loss*f*T\n" +
      statement + "\n}\n");
}

}  // namespace

TEST_CASE("a factor of the size of the declared unit converts twice") {
  for (auto const& [statement, cure] : {std::pair("derive a [deg] = phi*180/pi", "write `phi`"),
                                        {"derive a [deg] = 57.3*phi", "write `phi`"},
                                        {"derive a [rpm] = 60*sqrt(G/J)/(2*pi)", "write `sqrt(G/J)`"},
                                        {"derive a [rpm] = 60*f", "write `2*pi*f`"},
                                        {"derive a [rpm] = 60/T", "write `2*pi/T`"},
                                        {"derive a [ms] = 1000*2*pi*sqrt(J/G)", "write `2*pi*sqrt(J/G)`"},
                                        {"derive a [hp] = G*f/745.7", "write `G*f`"},
                                        {"derive a = sin(phi*pi/180)", "write `phi`"},
                                        {"derive a = cos(2*phi/57.2958)", "write `2*phi`"}}) {
    CAPTURE(statement);
    std::string const said = with(statement);
    CHECK(errors_in(said) == 0);
    CHECK(said.find("warning[E2214]") != std::string::npos);
    CHECK(said.find("warning[") == said.rfind("warning["));
    CHECK(said.find(cure) != std::string::npos);
  }
  for (char const* const statement : {"derive a [deg] = 2*phi", "derive a [Hz] = sqrt(G/J)/(2*pi)",
                                      "derive a [ms] = 2*pi*sqrt(J/G)", "derive a [percent] = 50*loss", "derive a [-] = 100*loss",
                                      "derive a = sin(pi/2 + phi)", "derive a = sin(pi*f*2*pi/180/1 [Hz])"}) {
    CAPTURE(statement);
    CHECK(with(statement).find("E2214") == std::string::npos);
  }
}

TEST_CASE("a bare number beside degrees is in radians, which is said") {
  for (auto const& [statement, cure] : {std::pair("derive a = if phi > 30 then 1 else 0", "`30 [deg]` or `30 [rad]`"),
                                        {"derive a = max(phi - 30, 0)", "`30 [deg]`"},
                                        {"derive a = clamp(phi, -30, 30)", "`-30 [deg]`"},
                                        {"derive a = sin(phi - 2*15)", "multiply it by `1 [deg]`"},
                                        {"derive a = if loss > 5 then 1 else 0", "`5 [percent]` or `5 [-]`"}}) {
    CAPTURE(statement);
    std::string const said = with(statement);
    CHECK(errors_in(said) == 0);
    CHECK(said.find("warning[E2213]") != std::string::npos);
    CHECK(said.find(cure) != std::string::npos);
  }
  for (char const* const statement :
       {"derive a = if phi > 0 then 1 else 0", "derive a = phi - pi/2", "derive a = phi - 30 [deg]", "derive a = 1 - loss",
        "derive a = if loss > 0.05 then 1 else 0", "derive a [deg] = 30", "derive a = 1 + phi/1 [rad]"}) {
    CAPTURE(statement);
    CHECK(with(statement).find("E2213") == std::string::npos);
  }
}

TEST_CASE("a spread in the unit of another power is refused where the dimension does not tell") {
  for (auto const& [noise, cure] : {std::pair("variance = s", "write `sd = s`, or `variance = s^2`"),
                                    {"precision = s", "write `sd = s`, or `precision = 1/s^2`"},
                                    {"sd = s^2", "write `variance = s^2`"}}) {
    CAPTURE(noise);
    std::string const said = with(std::string("observe other [deg] ~ normal(phi, ") + noise + ")");
    CHECK(errors_in(said) == 1);
    CHECK(said.find("error[E2205]") != std::string::npos);
    CHECK(said.find(cure) != std::string::npos);
  }
  for (char const* const noise : {"variance = s^2", "precision = 1/s^2", "sd = s", "sd = 0.1", "variance = 0.01"})
    CHECK(errors_in(with(std::string("observe other [deg] ~ normal(phi, ") + noise + ")")) == 0);
}

TEST_CASE("a minus before a converting factor stays before the rest") {
  for (auto const& [statement, cure] : {std::pair("derive a [rpm] = -60*f", "write `-2*pi*f`"),
                                        {"derive a [deg] = -phi*180/pi", "write `-phi`"},
                                        {"derive a [ms] = -(1000*T)", "write `T`"},  // in place of the parentheses
                                        {"derive a [rpm] = -60/T", "write `-2*pi/T`"}}) {
    CAPTURE(statement);
    std::string const said = with(statement);
    CHECK(said.find("warning[E2214]") != std::string::npos);
    CHECK(said.find(cure) != std::string::npos);
  }
}

TEST_CASE("numbers that a formula may have of its own are no conversions") {
  for (char const* const statement :
       {"derive a = 0.11*phi*180/pi + loss", "derive a [-] = phi*180/pi", "derive a = if phi*180/pi > 15 then 1 else 0",
        "observe other [-] ~ normal(phi*180/pi, sd = 1)",   // the number of degrees is wanted
        "derive a [rev/s] = 1/T",                           // nothing to convert
        "derive a [min] = 0.5*f*T*T/30",                    // 1/60 by chance
        "derive a [kN] = 0.001*200 [GPa]*1 [cm^2]*phi"}) {  // a strain
    CAPTURE(statement);
    std::string const said = with(statement);
    CHECK(errors_in(said) == 0);
    CHECK(said.find("E2214") == std::string::npos);
  }
}

TEST_CASE("a small number that keeps a quotient finite is clear beside an angle") {
  CHECK(with("derive a = phi/(abs(phi) + 1e-6)").find("E2213") == std::string::npos);
}

TEST_CASE("a spread in another unit of a share is no power of it") {
  std::string const shares =
      "parameter p [ppm] ~ half_normal(sd = 5)\nparameter q [percent] ~ half_normal(sd = 5)\nparameter e [mm/m] ~ normal(0, sd = ";
  CHECK(errors_in(with(shares + "p)")) == 0);
  CHECK(errors_in(with("parameter p [microstrain] ~ half_normal(sd = 5)\nobserve other [mm/m] ~ normal(loss, sd = p)")) == 0);
  std::string const said = with(shares + "p)\nobserve other [percent] ~ normal(loss, variance = q)");
  CHECK(said.find("write `sd = q`, or `variance = q^2`") != std::string::npos);
}

TEST_CASE("what is declared as a pure number takes an angle, a share of the noise does not") {
  auto const simulated = [](std::string const& options) {
    return messages(
        "model m {\ninput u [-]\nstate y [-]\ninitial y = 0\nparameter r [1/s] = 1\nparameter phi0 [-] ~ normal(0, sd = 1)\ny' = "
        "-r*y + r*u + "
        "r*sin(phi0)\n"
        "observe level ~ normal(y, sd = 0.1)\n}\ns = simulate m with values(phi0 = 30 [deg]), samples = 10, rate = 9, file = "
        "\"a.csv\", " +
        options + "\n");
  };
  CHECK(errors_in(simulated("input u = constant(value = 10 [deg])")) == 0);
  CHECK(errors_in(simulated("input u = sine(amplitude = 1 [deg], frequency = 1 [Hz])")) == 0);
  std::string const said = simulated("input u = constant(value = 1), noise = 10 [deg]");
  CHECK(said.find("error[E2014]") != std::string::npos);
  std::string const count = simulated("input u = constant(value = 1), seed = 10 [deg]");
  CHECK(count.find("number of radians") != std::string::npos);
  CHECK(count.find("remove the unit") == std::string::npos);
}

TEST_CASE("a factor of an equation that has the size of the unit of another factor converts twice") {
  auto const in_equation = [](std::string const& spring) {
    return messages(
        "model m {\ninput x [N]\nstate y [mm]\ninitial y = 0, y' = 0\nparameter k [N/mm] ~ log_uniform(1, 100)\n"
        "parameter tau [min] ~ log_uniform(1, 100)\nparameter c [N s/m] ~ log_uniform(1, 100)\n1 [kg]*y'' + " +
        spring + " = x\nobserve d ~ normal(y, sd = 0.1)\nderive t [s] = tau\nderive s = c*1 [m/N] + k*0\n}\n");
  };
  for (auto const& [spring, cure] : {std::pair("c*y' + 1000*k*y", "write `k*y`"), {"k*y + c*y/(60*tau)", "write `c*y/tau`"}}) {
    CAPTURE(spring);
    std::string const said = in_equation(spring);
    CHECK(said.find("warning[E2214]") != std::string::npos);
    CHECK(said.find(cure) != std::string::npos);
  }
  for (char const* const spring :
       {"c*y' + k*y", "c*y' + 3*k*y", "1000*c*y' + k*y", "k*y + 0.001*k*y", "c*y' + k*y*(1 + 1000*y/1 [km])"}) {
    CAPTURE(spring);
    CHECK(in_equation(spring).find("E2214") == std::string::npos);
  }
}

TEST_CASE("a number inside a sine that is one of degrees is in radians, which is said") {
  for (auto const& [statement, cure] : {std::pair("derive a = sin(45)", "`45 [deg]`"),
                                        {"derive a = cos(f*T + 90)", "`90 [deg]`"},
                                        {"derive a = sin(-30)", "`30 [deg]`"}}) {
    CAPTURE(statement);
    std::string const said = with(statement);
    CHECK(said.find("warning[E2213]") != std::string::npos);
    CHECK(said.find(cure) != std::string::npos);
  }
  for (char const* const statement :
       {"derive a = sin(1.5)", "derive a = cos(f*T + 2)", "derive a = sin(90 [deg] + phi)", "derive a = exp(-30)",
        "derive a = sin(f*T + 100)", "derive a = sin(30*f*T)", "derive a = sin(f*T - 30)"}) {
    CAPTURE(statement);
    CHECK(with(statement).find("E2213") == std::string::npos);
  }
}

TEST_CASE("a named number without a unit beside millimetres is in metres, which is said") {
  auto const said = [](std::string const& constant, std::string const& force) {
    return messages("model m {\nstate y [mm]\ninitial y = 1, y' = 0\nparameter k [N/m] ~ log_uniform(1, 100)\n" + constant +
                    "\n1 [kg]*y'' + " + force + " = 0\nobserve d ~ normal(y, sd = 0.1)\n}\n");
  };
  std::string const stop = "k*max(y - gap, 0)";
  CHECK(said("let gap = 0.1", stop).find("declare `gap` in [mm] or in [m]") != std::string::npos);
  CHECK(said("let gap [mm] = 0.1", stop).empty());
  CHECK(said("let gap = 0", stop).empty());
  CHECK(said("let eps = 1e-9", "k*y/(abs(y) + eps)*1 [mm]").find("E2213") == std::string::npos);
  std::string const of_filter = messages(
      "model m {\ntime discrete 1 [s]\ninput x [mm]\nstate y [mm]\ninitial y = 0\nparameter s [mm] ~ half_normal(sd = 1)\n"
      "y = 0.999*lag(y, 1) + 0.001*x\nobserve d ~ normal(y, sd = s)\n}\n");
  CHECK(of_filter.empty());
  std::string const of_argument = messages(
      "function g(u, w) = 0.001*u + w\nmodel m {\ninput u [mV], q [V]\nstate v [V]\ninitial v = 0\n1 [s]*v' = g(q, 3 [V]) "
      "- v + u\nobserve d ~ normal(v, sd = 0.1)\n}\n");
  CHECK(of_argument.find("E2214") == std::string::npos);
  CHECK(said("let gap [mm] = 0.1", "k*max(y - 0.1, 0)").find("E2213") == std::string::npos);
}

TEST_CASE("the numbers of a prior that look like those of the other unit of angles are doubted") {
  auto const of_prior = [](std::string const& parameter) {
    return messages("model m {\nstate y\ninitial y = 1, y' = 0\nparameter " + parameter +
                    "\ny'' + y*cos(lean)/1 [s^2] = 0\nobserve d ~ normal(y, sd = 0.1)\n}\n");
  };
  for (char const* const wrong : {"lean [rad] ~ uniform(-180, 180)", "lean [rad] ~ normal(45, sd = 5)",
                                  "lean [deg] ~ uniform(0, 2*pi)", "lean [deg] ~ normal(pi/4, sd = 0.1)"}) {
    CAPTURE(wrong);
    CHECK(of_prior(wrong).find("warning[E2213]") != std::string::npos);
  }
  for (char const* const right :
       {"lean [rad] ~ uniform(-pi, pi)", "lean [deg] ~ uniform(-180, 180)", "lean [rad] ~ normal(0.8, sd = 0.1)",
        "lean [rad] ~ uniform(0, 180 [deg])", "lean ~ uniform(0, 45)", "lean [rad] ~ uniform(0, 100)",
        "lean [deg] ~ uniform(0, 2*pi*1 [rad])", "lean [deg] ~ normal(0, sd = 180/pi*0.05)"}) {
    CAPTURE(right);
    CHECK(of_prior(right).find("E2213") == std::string::npos);
  }
}
