// Equations as printed to first-order systems; expected accelerations are solved by hand.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const reduced_head =
    "input x\nstate y\ninitial y = 0, y' = 0\nparameter m ~ normal(1, sd = 1)\nparameter c = 1\nparameter k = 1\n"
    "observe d ~ normal(y, sd = 1)\n";
Values const point = {{"x", 3}, {"y", 0.5}, {"y'", -2}, {"m", 4}, {"c", 0.25}, {"k", 6}};
double const acceleration = (3 - 0.25 * -2 - 6 * 0.5) / 4;

std::string const two_masses =
    "input x\nstate y1, y2\ninitial y1 = 0, y1' = 0, y2 = 0, y2' = 0\nparameter m1 = 1\nparameter m2 = 1\nparameter k1 = 1\n"
    "parameter k2 = 1\nparameter a ~ normal(0, sd = 1)\nobserve d ~ normal(a*y1, sd = 1)\n";
Values const masses = {{"x", 5},  {"y1", 2}, {"y2", -1}, {"y1'", 0}, {"y2'", 0},
                       {"m1", 3}, {"m2", 7}, {"k1", 11}, {"k2", 13}, {"a", 1}};

}  // namespace

TEST_CASE("an equation means the same in every arrangement") {
  for (char const* equation :
       {"m*y'' + c*y' + k*y = x", "x = m*y'' + c*y' + k*y", "m*y'' = x - c*y' - k*y", "c*y' + k*y - x = (-m)*y''",
        "y'' = (x - c*y' - k*y)/m", "0 = x - k*y - c*y' - m*y''", "2*(m*y'' + c*y') + 2*k*y = 2*x", "(x - m*y'')/(c*y' + k*y) = 1",
        "m*y''/2 + m*y''/2 = x - (c*y' + k*y)"}) {
    CAPTURE(equation);
    Model const model = model_of(reduced_head + equation);
    REQUIRE(model.states.size() == 2);
    CHECK(rate_of(model, "y", point) == -2);
    CHECK(rate_of(model, "y'", point) == near(acceleration));
  }
}

TEST_CASE("coupled masses are solved together") {
  Model const model = model_of(two_masses + "m1*y1'' + k1*y1 + k2*(y1 - y2) = x\nm2*y2'' + k2*(y2 - y1) = 0");
  CHECK(rate_of(model, "y1'", masses) == near((5 - 11 * 2 - 13 * 3) / 3.0));
  CHECK(rate_of(model, "y2'", masses) == near(13 * 3 / 7.0));
}

TEST_CASE("inertial coupling: several highest derivatives in every equation") {
  Model const model = model_of(two_masses + "m1*(y1'' + y2'') = x\ny1'' - y2'' = k1*y1");
  // sum 5/3, difference 22
  CHECK(rate_of(model, "y1'", masses) == near((5 / 3.0 + 22) / 2));
  CHECK(rate_of(model, "y2'", masses) == near((5 / 3.0 - 22) / 2));
}

TEST_CASE("a pendulum on a cart: the mass matrix depends on the state") {
  Model const model = model_of(
      "input x\nstate s, phi\ninitial s = 0, s' = 0, phi = 0, phi' = 0\nparameter M = 1\nparameter l ~ normal(1, sd = 1)\n"
      "M*s'' + l*cos(phi)*phi'' = x + l*sin(phi)*phi'^2\nl*phi'' + cos(phi)*s'' = -9.81*sin(phi)\n"
      "observe d ~ normal(s, sd = 1)");
  Values const v = {{"x", 2}, {"s", 0}, {"s'", 0}, {"phi", 0.3}, {"phi'", 0.7}, {"M", 5}, {"l", 1.5}};
  double const cosine = std::cos(0.3), sine = std::sin(0.3);
  // Cramer's rule
  double const b1 = 2 + 1.5 * sine * 0.49, b2 = -9.81 * sine, determinant = 5 * 1.5 - 1.5 * cosine * cosine;
  CHECK(rate_of(model, "s'", v) == doctest::Approx((b1 * 1.5 - 1.5 * cosine * b2) / determinant).epsilon(1e-13));
  CHECK(rate_of(model, "phi'", v) == doctest::Approx((5 * b2 - cosine * b1) / determinant).epsilon(1e-13));
}

TEST_CASE("a third-order equation has three components with units per second") {
  Model const model = model_of(
      "state y [m]\ninitial y = 1, y' = 2, y'' = 3\nparameter a ~ normal(0, sd = 1)\n"
      "y''' + a*y'' + 1 [1/s^3]*y = 0\nobserve d ~ normal(y, sd = 1)");
  REQUIRE(model.states.size() == 3);
  CHECK(model.states[2].name == "y''");
  CHECK(model.states[2].unit_text() == "m/s^2");
  Values const v = {{"y", 2}, {"y'", 3}, {"y''", 5}, {"a", 7}};
  CHECK(rate_of(model, "y", v) == 3);
  CHECK(rate_of(model, "y'", v) == 5);
  CHECK(rate_of(model, "y''", v) == near(-7 * 5 - 2));
  CHECK(initial_of(model, "y''") == 3);
}

TEST_CASE("states of different order stand in one system: Bouc-Wen") {
  Model const model = model_of(
      "input x\nstate y, z\ninitial y = 0, y' = 0, z = 0\nparameter m = 1\nparameter c = 1\nparameter A ~ normal(1, sd = 1)\n"
      "parameter alpha = 1\nparameter beta = 1\nparameter n = 2\nm*y'' + c*y' + z = x\n"
      "z' = A*y' - alpha*abs(y')*abs(z)^(n-1)*z - beta*y'*abs(z)^n\nobserve d ~ normal(y, sd = 1)");
  REQUIRE(model.states.size() == 3);
  Values const v = {{"x", 1}, {"y", 0}, {"y'", -2}, {"z", 0.5}, {"m", 2}, {"c", 3}, {"A", 4}, {"alpha", 5}, {"beta", 6}, {"n", 2}};
  CHECK(rate_of(model, "y'", v) == near((1 + 6 - 0.5) / 2));
  // A y' - alpha |y'| |z| z - beta y' |z|^2
  CHECK(rate_of(model, "z", v) == doctest::Approx(4 * -2 - 5 * 2 * 0.5 * 0.5 - 6 * -2 * 0.25).epsilon(1e-13));
}

TEST_CASE("a highest derivative may stand in a definition or a function") {
  for (char const* statements :
       {"let inertia = m*y''\ninertia + c*y' + k*y = x", "let right = x - damping\nlet damping = c*y' + k*y\nm*y'' = right",
        "function force(a) = m*a\nforce(y'') + c*y' + k*y = x", "function inertia() = m*y''\ninertia() + c*y' + k*y = x"}) {
    CAPTURE(statements);
    Model const model = model_of(reduced_head + statements);
    CHECK(model.states.size() == 2);
    CHECK(rate_of(model, "y'", point) == near(acceleration));
  }
}

TEST_CASE("a derived acceleration does not raise the order of its state") {
  std::string const shown = messages(
      "model m {\nstate y\ninitial y = 1\nparameter k ~ normal(1, sd = 1)\ny' = -k*y\nderive a = y''\n"
      "observe d ~ normal(y, sd = 1)\n}\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E2007]") != std::string::npos);
}

TEST_CASE("an observed or derived highest derivative is its solution") {
  Model const model =
      model_of(reduced_head + "m*y'' + c*y' + k*y = x\nobserve acceleration ~ normal(y'', sd = 1)\nderive power = m*y''*y'");
  CHECK(at(model, model.channels[1].noise.arguments[0], point) == near(acceleration));
  CHECK(at(model, model.derived[0].value, point) == near(4 * acceleration * -2));
  CHECK(model.derived[0].per_sample);
}

TEST_CASE("an equation that is not linear in a highest derivative makes the model implicit") {
  for (char const* equation : {"(y'')^2 = x", "sin(y'') = x", "m*y'' + abs(y'') = x", "y''*y'' = x", "1/y'' = x"}) {
    CAPTURE(equation);
    Model const model = model_of(reduced_head + equation);
    REQUIRE(model.implicit);
    CHECK(model.implicit->unknown == "y''");
  }
}

TEST_CASE("equations that say the same thing twice leave a state undetermined") {
  std::string const shown = messages("model m {\n" + two_masses + "m1*y1'' + m1*y2'' = x\n2*y1'' + 2*y2'' = k1*y1\n}\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E3005]: the equations do not determine") != std::string::npos);
}

TEST_CASE("the surplus equation is the one that finds no state left") {
  std::string const shown = messages("model m {\n" + reduced_head + "m*y'' = x\nc*y'' = k*y\n}\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("test.sysid:10:1: error[E3003]") != std::string::npos);
}

TEST_CASE("equations find their states in any order") {
  Model const model = model_of(two_masses + "m2*y2'' + m1*y1'' = x\nm1*y1'' = k1*y1");
  CHECK(rate_of(model, "y1'", masses) == near(22 / 3.0));
  CHECK(rate_of(model, "y2'", masses) == near((5 - 22) / 7.0));
}

TEST_CASE("a small coefficient is no pivot where another equation has a large one") {
  // a' = (3 - 1)/(2 - 1e-20), b' = 1 - 1e-20 a'; the second pair is the first with its equations in other units.
  for (char const* equations :
       {"1e-20*a' + b' = 1\n2*a' + b' = 3", "1e-20*a' + b' = 1\n2e-25*a' + 1e-25*b' = 3e-25", "2*a' + b' = 3\n1e-20*a' + b' = 1"}) {
    CAPTURE(equations);
    Model const model = model_of(std::string("state a, b\ninitial a = 0, b = 0\nparameter s ~ normal(0, sd = 1)\n") + equations +
                                 "\nobserve d ~ normal(s*a, sd = 1)");
    CHECK(rate_of(model, "a", {}) == near(1));
    CHECK(rate_of(model, "b", {}) == near(1));
  }
}

TEST_CASE("equations of very different size determine their unknowns; those that repeat one another do not") {
  // A capacitance in farad beside a mass in kilogram.
  std::string const piezo =
      "input x [N]\nstate y [m], v [V]\ninitial y = 0, y' = 0, v = 0\nconstant C [F] = 1e-12\nparameter k [N/m] ~ log_uniform(1, "
      "1e4)\n"
      "1 [kg]*y'' + 5 [N s/m]*y' + k*y = x\nC*v' + 1e-9 [S]*v = 1e-9 [A s/m]*y'\nobserve u ~ normal(v, sd = 0.001)\n";
  CHECK(messages("model m {\n" + piezo + "}\n").empty());
  std::string const head_of_two = "state a, b\ninitial a = 0, b = 0\nparameter p ~ uniform(1, 2)\nobserve d ~ normal(a, sd = 1)\n";
  CHECK(messages("model m {\n" + head_of_two + "a' + 1e-12*p*b' = -a\na' + 2e-12*p*b' = -b\n}\n").empty());
  std::string const repeated = messages("model m {\n" + head_of_two + "a' + 1e-12*p*b' = -a\n3e-9*a'*p + 3e-21*p^2*b' = -b\n}\n");
  CHECK(repeated.find("E3005") != std::string::npos);
}
