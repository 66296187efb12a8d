// Vectors and matrices: what an equation of vectors is, number by number.
#include <chrono>

#include "check/checking.hpp"
#include "sanitized.hpp"
#include "syntax/unparse.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

// The statements of the only model of a file, written out in numbers.
std::string flat(std::string const& statements) {
  std::string const text = unparse(checked("model m {\n" + statements + "\n}\n").tree);
  auto const begin = text.find("{\n") + 2;
  return text.substr(begin, text.rfind('}') - begin);
}

std::string chain(int n) {
  std::string const size = std::to_string(n);
  return "input x [N]\nstate q(" + size + ") [m]\ninitial q = 0, q' = 0\nparameter m(" + size +
         ") [kg] ~ log_uniform(0.1, 10)\nparameter k(" + size + ") [N/m] ~ log_uniform(1, 1e6)\nlet D = differences(" + size +
         ")\nlet K = transpose(D)*diagonal(k)*D\ndiagonal(m)*q'' + 0.1 [s]*K*q' + K*q = unit_vector(" + size + ", " + size +
         ")*x\nobserve y ~ normal(q[" + size + "], sd = 1)";
}

}  // namespace

TEST_CASE("a vector is written out in numbers with the user's names") {
  CHECK(flat("state q(2) [m]\ninitial q = (0, 1)\nparameter k(2) [1/s] ~ log_uniform(0.1, 10)\nq' = -diagonal(k)*q") ==
        "  state q[1] [m], q[2] [m]\n"
        "  initial q[1] = 0, q[2] = 1\n"
        "  parameter k[1] [1/s] ~ log_uniform(0.1, 10)\n"
        "  parameter k[2] [1/s] ~ log_uniform(0.1, 10)\n"
        "  q[1]' = -k[1]*q[1]\n"
        "  q[2]' = -k[2]*q[2]\n");
}

TEST_CASE("a coupled system M q'' + K q = B u is solved for its accelerations") {
  Model const model = model_of(
      "input u(2) [N]\nstate q(2) [m]\ninitial q = 0, q' = 0\nparameter a [kg] = 2\nparameter b [kg] = 0.5\n"
      "constant K(2, 2) [N/m] = ((30, -10), (-10, 20))\nlet M(2, 2) [kg] = ((a, b), (b, a))\n"
      "constant B(2, 2) = ((1, 0), (3, 1))\nM*q'' + K*q = B*u\nobserve y(2) ~ normal(q, sd = 1)");
  Values const at_point = {{"q[1]", 0.3}, {"q[2]", -0.2}, {"q[1]'", 0}, {"q[2]'", 0},
                           {"u[1]", 1.5}, {"u[2]", -4},   {"a", 2},     {"b", 0.5}};
  // By Cramer's rule on right = B u - K q.
  double const right1 = 1.5 - (30 * 0.3 + 10 * 0.2), right2 = 3 * 1.5 - 4 - (-10 * 0.3 - 20 * 0.2), determinant = 2 * 2 - 0.5 * 0.5;
  CHECK(rate_of(model, "q[1]'", at_point) == near((2 * right1 - 0.5 * right2) / determinant));
  CHECK(rate_of(model, "q[2]'", at_point) == near((2 * right2 - 0.5 * right1) / determinant));
  REQUIRE(model.channels.size() == 2);
  CHECK(model.channels[1].name == "y[2]");
}

TEST_CASE("functions of vectors") {
  Model const model = model_of(
      "state q(3)\ninitial q = (1, 2, 3)\nq' = -q\n"
      "derive total = sum(q)\nderive length = norm(q)\nderive work = dot(q, (4, 5, 6))\nderive cubes(3) = q^3\n"
      "derive image(3) = tridiagonal(-1, (2, 3, 4), (10, 20))*q\nderive form = transpose(q)*diagonal(1, 2, 3)*q\n"
      "derive sizes(3) = abs(q - 2)\nderive clipped(3) = if q > 2.5 then 0 else q\nderive outer(3, 3) = q*transpose(q)\n"
      "derive ranks(3) = integers(3) + ones(3) - identity(3)*zeros(3)\n"
      "observe y ~ normal(q[1], sd = 1)");
  Values const at_point = {{"q[1]", 1}, {"q[2]", -2}, {"q[3]", 3}};
  auto const value = [&](std::string const& name) {
    for (Derived const& each : model.derived)
      if (each.name == name) return at(model, each.value, at_point);
    FAIL("no " << name);
    return 0.0;
  };
  CHECK(value("total") == 2);
  CHECK(value("length") == near(std::sqrt(14.0)));
  CHECK(value("work") == 4 * 1 - 5 * 2 + 6 * 3);
  CHECK(value("cubes[2]") == -8);
  CHECK(value("image[1]") == 2 * 1 + 10 * -2);
  CHECK(value("image[2]") == -1 + 3 * -2 + 20 * 3);
  CHECK(value("image[3]") == 2 + 4 * 3);
  CHECK(value("form") == 1 * 1 + 2 * 4 + 3 * 9);
  CHECK(value("sizes[2]") == 4);
  CHECK(value("clipped[3]") == 0);
  CHECK(value("clipped[2]") == -2);
  CHECK(value("outer[2, 3]") == -6);
  CHECK(value("ranks[3]") == 4);
}

TEST_CASE("a function of the user's takes vectors") {
  Model const model = model_of(
      "function cubic(d, k, k3) = k*d + k3*d^3\nfunction energy(d) = sum(d^2)/2\nstate q(2)\ninitial q = 0\n"
      "q' = -cubic(q, 2, 5)\nderive e = energy(q)\nobserve y ~ normal(q[1], sd = 1)");
  Values const at_point = {{"q[1]", 1}, {"q[2]", -2}};
  CHECK(rate_of(model, "q[2]", at_point) == near(-(2 * -2 + 5 * -8)));
  CHECK(at(model, model.derived.at(0).value, at_point) == 2.5);
}

TEST_CASE("a function that calls itself with vectors is refused") {
  std::string const said =
      messages("model m {\nfunction f(a) = g(a)\nfunction g(a) = f(a) + (1, 2)\nstate q(2)\ninitial q = 0\nq' = f(q)\n}");
  CHECK(errors_in(said) == 1);
  CHECK(said.find("f() -> g() -> f()") != std::string::npos);
}

TEST_CASE("priors and values may differ by element") {
  Model const model = model_of(
      "parameter mu(2) ~ normal((1, 2), sd = 0.1)\nparameter c(2) = (5, 6)\nstate z\ninitial z = 0\nz' = -z*dot(mu, c)\n"
      "observe y ~ normal(z, sd = 1)");
  REQUIRE(model.parameters.size() == 4);
  CHECK(model.graph.constant_value(model.parameters[1].prior->arguments.at(0)) == 2);
  CHECK(model.graph.constant_value(*model.parameters[3].value) == 6);
}

TEST_CASE("a chain of ten masses checks in a tenth of a second") {
  auto const begin = std::chrono::steady_clock::now();
  Model const model = model_of(chain(10));
  std::chrono::duration<double> const seconds = std::chrono::steady_clock::now() - begin;
  CHECK(model.states.size() == 20);
  CHECK(seconds.count() < 2 * testing::slower);  // a machine that does other things as well
  Values values = {{"x", 7}};
  for (int i = 1; i <= 10; ++i) {
    std::string const index = "[" + std::to_string(i) + "]";
    values["q" + index] = 0.1 * i * i;
    values["q" + index + "'"] = 0;
    values["m" + index] = i;
    values["k" + index] = 100 + i;
  }
  // m_i q_i'' = k_(i+1) (q_(i+1) - q_i) - k_i (q_i - q_(i-1)), written out for the fourth and the last mass
  CHECK(rate_of(model, "q[4]'", values) == near((105 * (2.5 - 1.6) - 104 * (1.6 - 0.9)) / 4));
  CHECK(rate_of(model, "q[10]'", values) == near((7 - 110 * (10.0 - 8.1)) / 10));
}

TEST_CASE("a small text cannot make a large model") {
  std::string const huge = messages("model m {\nstate q(10000)\ninitial q = 0\nq' = -sum(q)*q\n}");
  CHECK(huge.find("error[E2709]") != std::string::npos);
  CHECK(errors_in(huge) == 1);
  std::string doubling = "model m {\nfunction f0(a) = a + (1, 2)\n";
  for (int i = 1; i < 60; ++i)
    doubling +=
        "function f" + std::to_string(i) + "(a) = f" + std::to_string(i - 1) + "(a)*1 + f" + std::to_string(i - 1) + "(a)\n";
  std::string const deep = messages(doubling + "state q(2)\ninitial q = 0\nq' = f59(q)\n}");
  CHECK(deep.find("error[E2709]") != std::string::npos);
}

TEST_CASE("what is wrong with every element is said once") {
  CHECK(errors_in(messages("model m {\nstate q(3)\ninitial q = 0\nq' = -stiffness*q\nobserve y ~ normal(q[1], sd = 1)\n}")) == 1);
}

TEST_CASE("a derived quantity says its size, so that a comma too many is found") {
  std::string const model = "model m {\nstate y\ninitial y = 0\ny' = -y\nobserve o ~ normal(y, sd = 1)\n";
  CHECK(messages(model + "derive r = sqrt((y, 2))\n}").find("error[E2705]") != std::string::npos);
  CHECK(messages(model + "derive r(2) = sqrt((y, 2))\n}").empty());
}

TEST_CASE("a vector of many states is refused before any work is done on it") {
  CHECK(messages("model m {\nstate q(5000)\ninitial q = 0\nq' = -q\n}").find("error[E2709]") != std::string::npos);
}
