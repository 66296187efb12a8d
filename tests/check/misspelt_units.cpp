// What is said of units that are written as elsewhere.
#include <doctest/doctest.h>

#include "check/checking.hpp"
#include "core/numeric/unit.hpp"

using namespace sysid;

TEST_CASE("a unit with several slips is told once, as it should be written whole") {
  for (auto const& [unit, whole] : {std::pair("N/m3", "[N/m^3]"),
                                    {"kgm/s2", "[kg m/s^2]"},
                                    {"kg/ms2", "[kg/(m s^2)]"},
                                    {"1/Nm", "[1/(N m)]"},
                                    {"Nm/Kg", "[N m/kg]"},
                                    {"J/kgK", "[J/(kg K)]"},
                                    {"1/mM", "[1/(mmol/l)]"},
                                    {"m/kmh", "[m/(km/h)]"}}) {
    CAPTURE(unit);
    std::string const said =
        test::messages("model m {\nparameter c [" + std::string(unit) + "] = 1\nobserve d ~ normal(c, sd = 1)\n}\n");
    CHECK(said.find("E2011") == said.rfind("[E2011]") + 1);
    CHECK(said.find("`" + std::string(whole) + "`\n") != std::string::npos);
  }
}

namespace {

std::string heater(std::string const& state, std::string const& capacity, std::string const& ambient = "degC") {
  return test::messages("model m {\ninput P [W]\nstate T [" + state + "]\ninitial T = Ta\nparameter Ta [" + ambient +
                        "] ~ normal(20, sd = 5)\n" + "parameter C [" + capacity +
                        "] ~ log_uniform(1, 2)\nparameter h [W/K] ~ log_uniform(1, 2)\n" +
                        "C*T' = P - h*(T - Ta)\nobserve temp ~ normal(T, sd = 1)\n}\n");
}

}  // namespace

TEST_CASE("letters of temperatures that are other units here are told once, where they conflict") {
  std::string const said = heater("C", "J/K");
  CHECK(said.find("error[") == said.rfind("error["));
  CHECK(said.find("`[C]` is the coulomb: a temperature in degrees Celsius is in `[degC]`") != std::string::npos);
  CHECK(heater("degC", "J/C").find("as in `[J/K]`") != std::string::npos);
  CHECK(heater("F", "J/K", "degF").find("`[degF]`") != std::string::npos);
  CHECK(heater("degC", "J/K").empty());
  // Inside the covariance of an unknown function as well.
  std::string const covariance = test::messages(
      "model m {\ninput T [degC]\nparameter s [mm] ~ half_normal(sd = 5)\nparameter n [mm] ~ half_normal(sd = 5)\n"
      "function d(T) ~ gp(squared_exponential(amplitude = s, length = 10 [C]))\nobserve y [mm] ~ normal(d(T), sd = n)\n}\n");
  CHECK(covariance.find("`[C]` is the coulomb") != std::string::npos);
  // A charge is one where no temperature would agree better.
  std::string const charge =
      test::messages("model m {\ninput q [C]\nparameter c [F] ~ log_uniform(1, 2)\nobserve u [V] ~ normal(q*c, sd = 1)\n}\n");
  CHECK(charge.find("E2205") != std::string::npos);
  CHECK(charge.find("deg") == std::string::npos);
}

TEST_CASE("revolutions in other words are `rev`") {
  for (char const* const unit : {"r/min", "rot/min"}) {
    CAPTURE(unit);
    CHECK(test::messages("model m {\nparameter c [" + std::string(unit) + "] = 1\nobserve d ~ normal(c, sd = 1)\n}\n")
              .find("did you mean `rev`?") != std::string::npos);
  }
  CHECK(test::messages("model m {\nparameter c [rev/min] = 1\nobserve d ~ normal(c, sd = 1)\n}\n").empty());
}

TEST_CASE("a mass is declared as its weight only where it is needed as nothing else") {
  auto const with = [](std::string const& statements) {
    return test::messages(
        "model m {\ninput u [lbf]\nstate z [ft]\ninitial z = 0, z' = 0\nparameter me [lb] ~ log_uniform(1, 10)\n"
        "parameter L [ft] ~ log_uniform(1, 10)\nobserve d ~ normal(z, sd = 1)\n" +
        statements + "\n}\n");
  };
  std::string const weight = "declare `me` in [lbf]";
  CHECK(with("10 [lb]*z'' + me*sin(z/L) = u").find(weight) != std::string::npos);
  for (char const* const statements : {"me*z'' + me*sin(z/L) = u", "constant g [m/s^2] = 9.81\n10 [lb]*z'' + me*sin(z/L) = u",
                                       "derive both [lb] = 2*me\n10 [lb]*z'' + me*sin(z/L) = u"}) {
    CAPTURE(statements);
    std::string const said = with(statements);
    CHECK(test::errors_in(said) == 1);
    CHECK(said.find(weight) == std::string::npos);
  }
}
