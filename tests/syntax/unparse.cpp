// Canonical text, and that it reads back as the same tree.
#include "syntax/unparse.hpp"

#include "parsing.hpp"
#include "random_tree.hpp"

using namespace sysid;
using test::parsed;
using test::parsed_expression;

namespace {

std::string canonical(std::string const& expression) { return unparse(parsed_expression(expression)); }

}  // namespace

TEST_CASE("only the parentheses that keep the tree are printed") {
  CHECK(canonical("((a) + ((b*c)))") == "a + b*c");
  CHECK(canonical("(a + b)*c") == "(a + b)*c");
  CHECK(canonical("a - (b - c)") == "a - (b - c)");
  CHECK(canonical("(a - b) - c") == "a - b - c");
  CHECK(canonical("(a^b)^c") == "(a^b)^c");
  CHECK(canonical("a^(b^c)") == "a^b^c");
  CHECK(canonical("(-a)^2") == "(-a)^2");
  CHECK(canonical("-(a^2)") == "-a^2");
  CHECK(canonical("2^(-1)") == "2^-1");
  CHECK(canonical("a*(-b)") == "a*-b");
  CHECK(canonical("(a < b) == (c < d)") == "(a < b) == (c < d)");
  CHECK(canonical("not (a and b)") == "not (a and b)");
  CHECK(canonical("(not a) and b") == "not a and b");
  CHECK(canonical("1 + (if a then b else c)") == "1 + (if a then b else c)");
  CHECK(canonical("f((a), b = (c, d))") == "f(a, b = (c, d))");
}

TEST_CASE("numbers are printed with the fewest digits that read back") {
  CHECK(canonical("1e-4") == "1e-4");
  CHECK(canonical("0.00001") == "1e-5");
  CHECK(canonical("50000000000") == "5e10");
  CHECK(canonical("1000") == "1000");
  CHECK(canonical("0.1000") == "0.1");
  CHECK(canonical("1e300") == "1e300");
}

TEST_CASE("units are printed as they are written by hand") {
  CHECK(canonical("1 [N*s / m]") == "1 [N s/m]");
  CHECK(canonical("1 [N^( 1-n )/m]") == "1 [N^(1 - n)/m]");
  CHECK(canonical("1 [m s^(-2)]") == "1 [m s^-2]");
  CHECK(canonical("1 [-]") == "1 [-]");
  CHECK(canonical("1 [N/( m*s )]") == "1 [N/(m s)]");
}

TEST_CASE("a whole file has one canonical text") {
  std::string const text =
      "model duffing \"Duffing's oscillator\" {\n"
      "  time t [s]\n"
      "  input x [N], u\n"
      "  state y [m]\n"
      "  initial y = 0, y' = 0\n"
      "  parameter m [kg] ~ log_uniform(0.1, 10)\n"
      "  parameter c [N s/m] = 2\n"
      "  parameter k\n"
      "  constant g [m/s^2] = 9.81\n"
      "  m*y'' + c*y' + k*y + k3*y^3 = x\n"
      "  observe displacement ~ normal(y, precision = beta)\n"
      "  derive fn [Hz] = sqrt(k/m)/(2*pi)\n"
      "}\n"
      "\n"
      "data bench {\n"
      "  file \"duffing.csv\"\n"
      "  time t [s]\n"
      "  step 1 [ms]\n"
      "  input x = force [N] hold zero_order\n"
      "  measure displacement = \"y noisy\" [mm]\n"
      "  split train = rows 1..500, test = rows 501..1500\n"
      "}\n"
      "\n"
      "function square(a) = a^2\n"
      "posterior = fit duffing to bench.train with mh(samples = 25000), start = rest\n"
      "forecast = predict posterior on bench.test with draws(200)\n"
      "both = predict posterior, other on bench.test with weights = stacking\n"
      "simulate duffing with input x = gaussian(sd = 10), noise = 1 [percent]\n";
  CHECK(unparse(parsed(text)) == text);
}

TEST_CASE("an equation that would begin with a sign begins with a parenthesis") {
  std::string const text = "model m {\n  (-k)*y + m = x\n  (-y) = 1\n}\n";
  CHECK(unparse(parsed(text)) == text);
  CHECK(unparse(parsed("model m {\n  (-k*y + m) = x\n  (-y) = 1\n}\n")) == text);
}

TEST_CASE("random trees read back as themselves") {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    ast::File const tree = test::RandomTree(seed).file();
    CAPTURE(seed);
    std::string const text = unparse(tree);
    bool const same = parsed(text) == tree;
    INFO(text);
    REQUIRE(same);
  }
}

TEST_CASE("random expressions read back as themselves, alone and with other layout") {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    ast::Expression const tree = test::RandomTree(seed).expression(6);
    CAPTURE(seed);
    std::string const text = unparse(tree);
    CHECK(parsed_expression(text) == tree);
    CHECK(parsed_expression("(\n" + text + "\n)") == tree);
    CHECK(unparse(parsed_expression(text)) == text);
  }
}
