// Names inside a model: order-free definitions, loops, functions; and no message that merely follows from another.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const head = "state y\ninitial y = 1\nparameter k ~ normal(1, sd = 1)\nobserve d ~ normal(y, sd = 1)\n";

std::string refused_definitions(std::string const& statements, std::string const& before = {}) {
  return messages(before + "model m {\n" + head + statements + "\n}\n");
}

}  // namespace

TEST_CASE("definitions may stand behind their use, in any order") {
  Model const model = model_of("y' = a\n" + head + "let a = b*y\nlet b = c + 1\nconstant c = 2");
  CHECK(rate_of(model, "y", {{"y", 5}}) == near(15));
}

TEST_CASE("a loop of definitions is written out once") {
  std::string const shown = refused_definitions("y' = a\nlet a = b + 1\nlet b = c + 1\nlet c = 2*a");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E2006]: this definition is circular: a -> b -> c -> a") != std::string::npos);
  CHECK(errors_in(refused_definitions("y' = a\nlet a = a + 1")) == 1);
}

TEST_CASE("a function that calls itself is refused") {
  std::string const shown = refused_definitions("y' = f(y)\nfunction f(a) = a*f(a - 1)");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("this definition is circular: f() -> f()") != std::string::npos);
}

TEST_CASE("arguments of a function hide the model's names, other names are the model's") {
  Model const model = model_of(head + "y' = f(2)\nfunction f(y) = k*y + z\nlet z = 10");
  CHECK(rate_of(model, "y", {{"y", 100}, {"k", 3}}) == near(16));
}

TEST_CASE("functions call functions, of the file and of the model") {
  Model const model = checked("function square(a) = a*a\nmodel m {\n" + head +
                              "y' = fourth(y)\nfunction fourth(a) = square(square(a))\n}\nfunction cube(a) = a^3\n")
                          .models.at(0);
  CHECK(rate_of(model, "y", {{"y", 2}}) == near(16));
}

TEST_CASE("arguments of a function keep their units") {
  Model const model = model_of(
      "state y [mm]\ninitial y = 0\nparameter k ~ normal(1, sd = 1)\nobserve d ~ normal(y, sd = 1)\nfunction dead(a, gap) = max(a "
      "- gap, 0)\n"
      "y' = dead(y, 3)/1 [s]");
  // a - gap: the number 3 takes the unit of y, mm
  CHECK(rate_of(model, "y", {{"y", 5e-3}}) == near(2e-3));
}

TEST_CASE("the user's function goes before a built-in one of the same name") {
  Model const model = model_of(head + "function step(a) = 7*a\ny' = step(y)");
  CHECK(rate_of(model, "y", {{"y", 2}}) == near(14));
}

TEST_CASE("every logical operator means what it says") {
  for (auto const& [condition, at_2] : std::map<std::string, double>{{"y < 2", 0},
                                                                     {"y <= 2", 1},
                                                                     {"y > 2", 0},
                                                                     {"y >= 2", 1},
                                                                     {"y == 2", 1},
                                                                     {"y != 2", 0},
                                                                     {"y > 1 and y < 3", 1},
                                                                     {"y < 1 or y > 3", 0},
                                                                     {"not y < 1", 1}}) {
    CAPTURE(condition);
    CHECK(rate_of(model_of(head + "y' = if " + condition + " then 1 else 0"), "y", {{"y", 2}}) == at_2);
  }
}

TEST_CASE("pi is a number unless the user has another") {
  CHECK(rate_of(model_of(head + "y' = pi"), "y", {}) == near(3.141592653589793));
  CHECK(rate_of(model_of(head + "y' = pi\nconstant pi = 3"), "y", {}) == near(3));
}

TEST_CASE("what a definition depends on decides how often it is reported") {
  Model const model =
      model_of(head + "y' = -k*y\nderive half_life = log(2)/k\nderive double = 2*y\nderive later = half_life*double");
  REQUIRE(model.derived.size() == 3);
  CHECK_FALSE(model.derived[0].per_sample);
  CHECK(model.derived[1].per_sample);
  CHECK(model.derived[2].per_sample);
  CHECK(at(model, model.derived[2].value, {{"k", 4}, {"y", 3}}) == near(std::log(2.0) / 4 * 6));
}

TEST_CASE("names near the wrong one are offered") {
  CHECK(refused_definitions("y' = -kk*y").find("help: did you mean `k`?") != std::string::npos);
  CHECK(refused_definitions("y' = -ln(y)").find("help: did you mean `log`?") != std::string::npos);
  CHECK(refused_definitions("y' = -pow(y, 2)").find("help: powers are written with ^: `y^2`") != std::string::npos);
  CHECK(refused_definitions("y' = -sqr(y)").find("help: did you mean `sqrt`") != std::string::npos);
  CHECK(refused_definitions("y' = -k(y)").find("`k` is a quantity, not a function") != std::string::npos);
}

TEST_CASE("several independent mistakes are all reported, and nothing follows from them") {
  std::string const shown = refused_definitions(
      "y' = -k*y + unknown1\nlet a = unknown2\nlet b = a + 1\nparameter p ~ nrmal(0, sd = 1)\nlet c = p + b\nderive e = sqrt(c, "
      "c)\n"
      "observe f ~ normal(b, sd = unknown3)");
  CHECK(errors_in(shown) == 5);
  for (char const* each : {"`unknown1`", "`unknown2`", "`nrmal`", "`sqrt` takes 1 argument", "`unknown3`"})
    CHECK_MESSAGE(shown.find(each) != std::string::npos, each);
}

TEST_CASE("a mistake in a model is not repeated by the tasks that use it") {
  std::string const shown =
      refused_definitions("y' = -kk*y") + messages("model m {\n" + head +
                                                   "y' = -kk*y\n}\nt = simulate m with samples = 10\nf = fit m with mh\n"
                                                   "p = predict f on nothing");
  CHECK(shown.find("model `m`") == std::string::npos);
  CHECK(shown.find("fit `f`") == std::string::npos);
}

TEST_CASE("a state without an equation is the only thing said about it") {
  std::string const shown = messages(
      "model m {\nstate y, z\ninitial y = 1, z = 0, z' = 0\nparameter k ~ normal(1, sd = 1)\ny' = -k*y\n"
      "observe d ~ normal(y, sd = 1)\nobserve e ~ normal(z', sd = 1)\n}\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E3001]: state `z` has no equation") != std::string::npos);
  CHECK(shown.find("help: write the equation that contains `z''`") != std::string::npos);  // as there is an initial z'
}

TEST_CASE("a name that nothing declares is said, not the shapes that it spoils") {
  std::string const shown = messages(
      "model m {\nstate y(2)\ninitial y = 0\nparameter k(2) ~ normal(1, sd = 1)\nlet K = diagonal(k)\ny' = -K*q + (0, 1)\n"
      "observe d(2) ~ normal(y, sd = 1)\n}\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E2001]: `q` is not declared in this model") != std::string::npos);
}
