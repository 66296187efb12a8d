// Plain numbers take the unit of what they meet; expected values are conversions by hand to coherent SI.
#include "checking.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

// Statements around which the tests put one more: y in mm, k in N/mm.
std::string const oscillator =
    "input x [N]\nstate y [mm]\ninitial y = 5, y' = 2\nparameter m [kg] = 2\nparameter k [N/mm] ~ log_uniform(1, 10)\n"
    "observe displacement ~ normal(y, sd = 0.1)\n";

// The right-hand side of a first-order state in mm, evaluated at y = 7 mm.
double rate_at_7_mm(std::string const& right) {
  Model const model = model_of("state y [mm]\ninitial y = 0\nparameter g = 3\nobserve d ~ normal(y, sd = 1)\ny' = " + right);
  return rate_of(model, "y", {{"y", 7e-3}, {"g", 3}});
}

Distribution prior(Model const& model) { return model.parameters.at(0).prior.value(); }

Model with_prior(std::string const& unit, std::string const& call) {
  return model_of("parameter a " + unit + " ~ " + call + "\nobserve c ~ normal(a, sd = 1)");
}

}  // namespace

TEST_CASE("initial values are in the unit of their state, derivatives per second") {
  Model const model = model_of(oscillator + "m*y'' + k*y = x");
  CHECK(initial_of(model, "y") == near(5e-3));
  CHECK(initial_of(model, "y'") == near(2e-3));
  CHECK(model.states[1].unit_text() == "mm/s");
  CHECK(model.states[1].from_si(2e-3) == near(2));
}

TEST_CASE("a number with a unit of its own is converted, not adapted") {
  Model const model = model_of("state y [mm]\ninitial y = 5 [m]\ny' = 3 [m/s]\nobserve d ~ normal(y, sd = 1 [um])");
  CHECK(initial_of(model, "y") == near(5));
  CHECK(rate_of(model, "y", {}) == near(3));
  CHECK(at(model, model.channels[0].noise.arguments[1], {}) == near(1e-6));
}

TEST_CASE("equations are in SI whatever the declared units are") {
  Model const model = model_of(oscillator + "m*y'' + k*y = x");
  // y'' = (x - k y)/m with k = 2 N/mm = 2000 N/m, y = 5 mm
  CHECK(rate_of(model, "y'", {{"x", 3}, {"k", 2000}, {"y", 5e-3}, {"m", 2}}) == near((3 - 10) / 2.0));
}

TEST_CASE("a number on one side of an equation takes the unit of the other") {
  Model const model = model_of(oscillator + "y'' = 3");
  CHECK(rate_of(model, "y'", {}) == near(3e-3));
}

TEST_CASE("addends, comparisons, branches and arguments of min adapt, factors do not") {
  CHECK(rate_at_7_mm("(y - 5)/1 [s]") == near(2e-3));
  CHECK(rate_at_7_mm("(5 - y)/1 [s]") == near(-2e-3));
  CHECK(rate_at_7_mm("2*y/1 [s]") == near(14e-3));
  CHECK(rate_at_7_mm("if y > 6 then 1 else 2") == near(1e-3));
  CHECK(rate_at_7_mm("if y > 8 then 1 else 2") == near(2e-3));
  CHECK(rate_at_7_mm("min(y, 5)/1 [s]") == near(5e-3));
  CHECK(rate_at_7_mm("max(5, y, 9)/1 [s]") == near(9e-3));
  CHECK(rate_at_7_mm("(y + (2 + 3))/1 [s]") == near(12e-3));
  CHECK(rate_at_7_mm("sqrt(16)") == near(4e-3));
}

TEST_CASE("what is undeclared is taken as it is") {
  // g has no unit: the number beside it stays 2, and nothing is known of the sum
  CHECK(rate_at_7_mm("g + 2") == near(5));
}

TEST_CASE("a definition with a unit gives its number that unit; without one the number is pure") {
  CHECK(rate_at_7_mm("1\nlet d [mm] = 5") == near(1e-3));
  Model const model = model_of(
      "state y [mm]\ninitial y = 0\nlet d [mm] = 5\nlet five = 5\n"
      "y' = (y - d)/1 [s]\nderive with_unit = y - d\nderive pure = y*five\nobserve c ~ normal(y, sd = 1)");
  CHECK(rate_of(model, "y", {{"y", 7e-3}}) == near(2e-3));
  CHECK(at(model, model.derived[0].value, {{"y", 7e-3}}) == near(2e-3));
  CHECK(at(model, model.derived[1].value, {{"y", 7e-3}}) == near(35e-3));
}

TEST_CASE("fixed values of parameters are in their unit") {
  CHECK(
      at(model_of("parameter k [N/mm] = 2\nparameter a ~ normal(0, sd = 1)\nobserve c ~ normal(a*k, sd = 1)"),
         *model_of("parameter k [N/mm] = 2\nparameter a ~ normal(0, sd = 1)\nobserve c ~ normal(a*k, sd = 1)").parameters[0].value,
         {}) == near(2000));
}

TEST_CASE("each argument of a prior has the power of the unit that its role has") {
  // 1 N/mm = 1000 N/m
  for (char const* call :
       {"normal(10, sd = 2)", "normal(10, variance = 4)", "normal(10, precision = 0.25)", "normal(mean = 10, sd = 2)"}) {
    CAPTURE(call);
    Model const model = with_prior("[N/mm]", call);
    CHECK(at(model, prior(model).arguments[0], {}) == near(10e3));
    CHECK(at(model, prior(model).arguments[1], {}) == near(2e3));
  }
  Model const shape = with_prior("[mm]", "gamma(3, rate = 4)");
  CHECK(at(shape, prior(shape).arguments[0], {}) == near(3));
  CHECK(at(shape, prior(shape).arguments[1], {}) == near(1e-3 / 4));
  // the width of a log-normal is that of a logarithm: a pure number
  Model const log_normal = with_prior("[mm]", "log_normal(2, sd = 0.5)");
  CHECK(at(log_normal, prior(log_normal).arguments[0], {}) == near(2e-3));
  CHECK(at(log_normal, prior(log_normal).arguments[1], {}) == near(0.5));
}

TEST_CASE("bounds are in the unit of the parameter, or in their own") {
  Model const model = with_prior("[N/mm]", "normal(10, sd = 2, lower = 5, upper = 20000 [N/m])");
  CHECK(at(model, prior(model).lower.value(), {}) == near(5e3));
  CHECK(at(model, prior(model).upper.value(), {}) == near(20e3));
  Model const open = with_prior("[N/mm]", "normal(10, sd = 2, lower = -inf, upper = inf)");
  CHECK_FALSE(prior(open).lower.has_value());
  CHECK_FALSE(prior(open).upper.has_value());
}

TEST_CASE("noise is in the unit of the channel: the declared one, else that of the model's value") {
  Model const model = model_of(oscillator +
                               "m*y'' + k*y = x\nobserve fine [um] ~ normal(y, sd = 3)\n"
                               "observe force ~ normal(k*y, precision = 4)");
  CHECK(model.channels[0].unit_text() == "mm");
  CHECK(at(model, model.channels[0].noise.arguments[1], {}) == near(0.1e-3));
  CHECK(at(model, model.channels[1].noise.arguments[1], {}) == near(3e-6));
  CHECK(at(model, model.channels[1].noise.arguments[0], {{"y", 5e-3}}) == near(5e-3));
  // N/mm times mm is N
  CHECK(at(model, model.channels[2].noise.arguments[1], {}) == near(0.5));
}

TEST_CASE("a temperature is counted from the zero of its unit, and shifted only between units") {
  Model const model = model_of(
      "state T [degC]\ninitial T = 293.15 [K]\nparameter Ta [degC] = 20\nT' = (Ta - T)/10 [s]\nobserve c ~ normal(T, sd = 1)");
  CHECK(initial_of(model, "T") == doctest::Approx(20).epsilon(1e-12));
  CHECK(at(model, *model.parameters[0].value, {}) == near(20));
  CHECK(rate_of(model, "T", {{"T", 30}, {"Ta", 20}}) == near(-1));
}

namespace {

// What is said of a statement about temperatures.
std::string of_temperatures(std::string const& statement) {
  return messages(
      "model m {\ninput T [degC], F [degF]\nparameter Ta [degC] = 20\nparameter Tk [K] = 310\nparameter Tl [K] = 300\n"
      "parameter rise [delta_degC] = 2\nparameter q [W] = 3\nparameter R [K/W] = 1\nparameter a ~ normal(0, sd = 1)\n"
      "derive all = a*T/1 [K] + F/Ta + Tk/Tl + rise*q*R/1 [K^2]\nobserve c [degC] ~ normal(Ta, sd = a*rise)\n" +
      statement + "\n}\n");
}

}  // namespace

TEST_CASE("temperatures that count from different zeros do not meet in an expression, unless one is a number outside a sum") {
  REQUIRE(of_temperatures("") == "");
  for (char const* statement : {"derive e = T + Tk",
                                "derive e = Tk - T",
                                "derive e = T + 2 [K]",
                                "derive e = T - 300 [K]",
                                "derive e = 0.5*T + 0.5*Tk",
                                "derive e = T + (Tk - Tl)",
                                "derive e = T - F",
                                "derive e = T - 50 [degF]",
                                "derive e = q*R - (T + Tk)",
                                "derive e [K] = T",
                                "derive e [degC] = Tk",
                                "derive e [degC] = F",
                                "derive e [degC] = q*R",
                                "derive e [degC] = T - Ta",
                                "derive e [delta_degC] = T",
                                "derive e = max(T, Tk)",
                                "derive e = if a > 0 then T else Tk",
                                "derive e = if T > Tk then 1 else 0",
                                "derive e = if T - Ta > 5 [degC] then 1 else 0",
                                "derive e = piecewise(a > 0, T, T - Ta)",
                                "observe d [degC] ~ normal(Tk, sd = 1)",
                                "observe d [degC] ~ normal(T - Ta, sd = 1)",
                                "parameter p [degC] ~ normal(Tk, sd = 1)",
                                "function f(b) = b + Tk\nderive e = f(T)"}) {
    CAPTURE(statement);
    std::string const said = of_temperatures(statement);
    CHECK_MESSAGE(errors_in(said) == 1, said);
    CHECK_MESSAGE(said.find("error[E2211]") != std::string::npos, said);
  }
  for (char const* statement : {"derive e = T + rise",
                                "derive e = rise + T",
                                "derive e = T + (T - Ta)",
                                "derive e = T + q*R",
                                "derive e [degC] = Ta + rise",
                                "derive e [delta_degC] = T - 20 [degC]",
                                "derive e [K] = T - Ta",
                                "derive e [K] = q*R",
                                "derive e = Tk + rise",
                                "derive e = Tk - Tl",
                                "derive e = if T > 300 [K] then 1 else 0",
                                "derive e = if T - Ta > 5 [K] then 1 else 0",
                                "derive e [degC] = max(T, 300 [K])",
                                "derive e [degC] = if a > 0 then 300 [K] else T",
                                "constant e [degC] = 300 [K]",
                                "derive e [delta_degF] = T - Ta",
                                "parameter s [degC] ~ half_normal(1)\nobserve d [degC] ~ normal(T, sd = s)",
                                "observe d [degC] ~ normal(T, sd = 2 [K])",
                                "parameter p [degC] ~ normal(300 [K], sd = 5 [K], lower = 0 [K])",
                                "function f(b) = b + rise\nderive e = f(T)"}) {
    CAPTURE(statement);
    std::string const said = of_temperatures(statement);
    CHECK_MESSAGE(errors_in(said) == 0, said);
  }
}

TEST_CASE("a difference keeps its size beside a temperature, and a number in another unit is converted to its zero") {
  Model const model = model_of(R"(
  input T [degC]
  parameter T1 [degC] ~ normal(20, sd = 1)
  parameter rise [delta_degF] ~ normal(0, sd = 1)
  derive a [degC] = T + rise
  derive b [degC] = T + (T - T1)
  derive c [degC] = max(T, 300 [K])
  derive d [degC] = if T > 300 [K] then T else 300 [K]
  derive e [degF] = 300 [K]
  observe f ~ normal(T, sd = 1)
)");
  Values const values = {{"T", 20}, {"T1", 15}, {"rise", 2}};  // degrees above 0 degC, and kelvin
  std::vector<double> const expected = {22, 25, 26.85, 26.85, 80.33};
  for (std::size_t i = 0; i < expected.size(); ++i)
    CHECK(model.derived.at(i).from_si(at(model, model.derived[i].value, values)) == doctest::Approx(expected[i]).epsilon(1e-12));
}

TEST_CASE("beside a pure number a bare number is pure, and ratios of like quantities are pure numbers") {
  Model const model = model_of(R"(
  input x
  state y [mm]
  initial y = 0
  parameter a [mm] = 500
  parameter l [m] = 2
  parameter zeta [percent] = 5
  y' = x - y/1 [s]
  derive stretched = 1 + a/l
  derive ratio = a/l
  derive damped = 1 - zeta
  observe d ~ normal(y, sd = 1)
)");
  auto const value = [&](std::size_t i) {
    double const si = model.graph.evaluate(model.derived.at(i).value, [&](NodeId leaf) {
      return *model.graph.constant_value(*model.parameters.at(static_cast<std::size_t>(model.graph[leaf].index)).value);
    });
    return model.derived.at(i).from_si(si);  // as it is printed
  };
  CHECK(value(0) == doctest::Approx(1.25).epsilon(1e-12));
  CHECK(value(1) == relative(0.25, 1e-12));
  CHECK(value(2) == doctest::Approx(0.95).epsilon(1e-12));
}

TEST_CASE("products, quotients, powers and roots of quantities count in SI, whatever their factors are declared in") {
  Model const model = model_of(
      "input x [mm]\nparameter k [N/m] ~ normal(3, sd = 1)\nparameter p [percent] ~ normal(3, sd = 1)\n"
      "parameter f [kHz] ~ normal(3, sd = 1)\nderive force = k*x\nderive part = p*100 [N]\nderive area = x^2\n"
      "derive angular = 2*pi*f\nobserve pull ~ normal(k*x + 5, sd = 1)\nobserve bare ~ normal(x + 5, sd = 1)");
  auto const derived = [&](std::string const& name) -> Derived const& {
    for (Derived const& each : model.derived)
      if (each.name == name) return each;
    throw std::out_of_range(name);
  };
  // Numbers beside units that have no name of their own are shown with the dimension: so they count in SI.
  for (char const* name : {"force", "part", "area", "angular"}) {
    CAPTURE(name);
    CHECK(derived(name).unit->text.empty());
    CHECK(derived(name).from_si(7) == near(7));
  }
  REQUIRE(model.channels.size() == 2);
  CHECK(model.channels[0].from_si(7) == near(7));
  CHECK(at(model, model.channels[0].noise.arguments[0], {{"k", 3}, {"x", 2e-3}}) == near(5.006));
  CHECK(model.channels[1].unit_text() == "mm");
  CHECK(at(model, model.channels[1].noise.arguments[0], {{"x", 2e-3}}) == near(7e-3));
}

TEST_CASE("a channel without a unit, of a product, has that of the size of its noise, where this is a name") {
  std::string const text =
      "input S [mmol/l], e [mmol/s], n [mol^2/s^2], p [percent]\nparameter V [mmol/s] ~ log_uniform(0.01, 100)\n"
      "parameter K [mmol/l] ~ log_uniform(0.01, 100)\nobserve v ~ ";
  auto const channel = [&](std::string const& noise) { return model_of(text + noise).channels.at(0); };
  CHECK(channel("normal(V*S/(K + S), sd = e)").unit_text() == "mmol/s");
  CHECK(channel("normal(V*S/(K + S), sd = e)").from_si(7) == near(7000));
  CHECK(channel("student_t(V*S/(K + S), 4, scale = e)").unit_text() == "mmol/s");
  CHECK(channel("normal(S/K, sd = p)").unit_text() != "percent");
  // Of another dimension, or computed, it says nothing of readings.
  CHECK(channel("normal(V*S/(K + S), variance = n)").from_si(7) == near(7));
  CHECK(channel("normal(V*S/(K + S), sd = 2*e)").from_si(7) == near(7));
}

TEST_CASE("a temperature without an initial value is given a parameter, other quantities 0") {
  auto const said = [](std::string const& unit, std::string const& more = "") {
    return messages("model m {\nstate T [" + unit + "]\nparameter k [1/s] ~ log_uniform(1, 2)\nparameter Ta [" + unit +
                    "] ~ normal(20, sd = 5)\n" + more + "T' = -k*(T - Ta)\nobserve d ~ normal(T, sd = 1)\n}\n");
  };
  CHECK(said("degC").find("write `initial T = T_start` and `parameter T_start [degC] ~ normal(20, sd = 20)`\n") !=
        std::string::npos);
  CHECK(said("degF").find("`parameter T_start [degF] ~ normal(68, sd = 36)`\n") != std::string::npos);
  CHECK(said("K").find("`parameter T_start [K] ~ normal(300, sd = 30)`; or, of a difference of temperatures, `initial T = 0`") !=
        std::string::npos);
  CHECK(said("mK").find("`parameter T_start [mK] ~ normal(3e+05, sd = 3e+04)`; or, of a difference of temperatures, ") !=
        std::string::npos);
  CHECK(said("delta_degC").find("write `initial T = 0`\n") != std::string::npos);
  CHECK(said("degC", "parameter T_start [s] ~ log_uniform(1, 2)\nderive u [s] = T_start\n").find("`initial T = T_start_2`") !=
        std::string::npos);
  CHECK(said("m").find("write `initial T = 0`\n") != std::string::npos);
}
