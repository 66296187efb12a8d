// Differential-algebraic and implicit models: which equations are differentiated, what is solved for, what is refused and why.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const pendulum =
    "state x [m], y [m], pull [N]\nparameter g [m/s^2] ~ log_uniform(1, 100)\nconstant l [m] = 2\nconstant m [kg] = 3\n"
    "initial x = l*sin(0.5), y = -l*cos(0.5), x' = 0, y' = 0\nm*x'' = -pull*x/l\nm*y'' = -pull*y/l - m*g\nx^2 + y^2 = l^2\n"
    "observe position ~ normal(x, sd = 1)\nobserve force ~ normal(pull, sd = 1)\n";

std::string const braking =
    "model braking {\nstate v [m/s]\nparameter a [m/s^3] ~ log_uniform(0.1, 10)\ninitial v = 10, v' = -1\n(v')^2 = a*v\n"
    "observe speed ~ normal(v, sd = 0.1)\n}\n";

std::string refused_model(std::string const& statements) { return messages("model m {\n" + statements + "\n}\n"); }

}  // namespace

TEST_CASE("a rod's constraint is differentiated twice, and the force behind it solved for") {
  Model const model = model_of(pendulum);
  REQUIRE(model.states.size() == 4);
  CHECK_FALSE(model.implicit);
  REQUIRE(model.unknowns.size() == 3);
  CHECK(model.unknowns[0].name == "x''");
  CHECK(model.unknowns[2].name == "pull");
  CHECK(model.unknowns[2].component == -1);
  REQUIRE(model.invariants.size() == 1);
  // On the circle pull = m (v^2 - g y)/l; x'' and y'' follow from it.
  Values const point = {{"x", 1.2}, {"y", -1.6}, {"x'", 0.8}, {"y'", 0.6}, {"g", 9.0}};
  double const pull = 3 * (1.0 + 9.0 * 1.6) / 2;
  CHECK(rate_of(model, "x'", point) == near(-pull * 1.2 / 2 / 3));
  CHECK(rate_of(model, "y'", point) == near(pull * 1.6 / 2 / 3 - 9));
  REQUIRE(model.derived.size() == 1);
  CHECK(model.derived[0].name == "pull");
  CHECK(model.derived[0].per_sample);
  CHECK(at(model, model.derived[0].value, point) == near(pull));
  CHECK(at(model, model.invariants[0].value, {{"x", 1}, {"y", 1}}) == near(2));
}

TEST_CASE("a constraint between a current and a voltage is solved as it stands") {
  Model const model = model_of(
      "input u\nstate q, i\nparameter r ~ log_uniform(1, 10)\ninitial q = 0\nq' = i\nr*i + q = u\nobserve d ~ normal(i, sd = 1)\n");
  CHECK(model.invariants.empty());
  CHECK(rate_of(model, "q", {{"u", 5}, {"q", 1}, {"r", 2}}) == near(2));
}

TEST_CASE("two capacitors side by side share their voltage: one differentiation") {
  Model const model = model_of(
      "input i\nstate u1, u2, i1\nparameter c1 ~ log_uniform(1, 10)\nconstant c2 = 4\ninitial u1 = 1, u2 = 1\nc1*u1' = i1\n"
      "c2*u2' = i - i1\nu1 = u2\nobserve d ~ normal(u1, sd = 1)\n");
  CHECK(model.invariants.size() == 1);
  CHECK(rate_of(model, "u1", {{"i", 3}, {"u1", 1}, {"u2", 1}, {"c1", 2}}) == near(0.5));
}

TEST_CASE("an equation that cannot be solved for a highest derivative makes an implicit model, with a guess for its branch") {
  Model const model = checked(braking).models.at(0);
  REQUIRE(model.implicit);
  CHECK(model.implicit->unknown == "v'");
  REQUIRE(model.unknowns.size() == 1);
  CHECK(at(model, model.unknowns[0].guess, {}) == near(-1));
  CHECK(model.residuals.size() == 1);
}

TEST_CASE("an implicit model is solved by ida, and by no solver of explicit equations") {
  std::string const data = "data d { file \"d.csv\"; rate 1 [Hz]; measure speed = v [m/s] }\n";
  CheckedFile const file = checked(braking + data + "fit braking to d with map");
  auto const& fit = std::get<FitTask>(file.tasks.at(0).what);
  CHECK(fit.solver.method == "ida");
  CHECK(fit.refine_solver);
  for (char const* solver : {"substeps = 2", "solver = rk4", "solver = cvode"}) {
    std::string const shown = messages(braking + data + "fit braking to d with map, " + solver);
    CHECK(errors_in(shown) == 1);
    CHECK(shown.find("error[E3004]") != std::string::npos);
    CHECK(shown.find("not linear in `v'`") != std::string::npos);
  }
}

TEST_CASE("what no differentiation can mend is refused by name") {
  std::string const driven =
      "input u [m]\nstate y [m], force [N]\ninitial y = 0, y' = 0\ny'' + y = force\ny = u\n"
      "observe d ~ normal(force, sd = 1)\n";
  CHECK(refused_model(driven).find("error[E3015]: this constraint prescribes a motion") != std::string::npos);
  std::string const tied = "input u\nstate y, a, b\ninitial y = 0\na = u\na = y\ny' = b\nobserve d ~ normal(y, sd = 1)\n";
  CHECK(refused_model(tied).find("error[E3016]") != std::string::npos);
  std::string const open = "state y, a, b\ninitial y = 0\ny' = a + b\na + b = 1\n2*a + 2*b = y\nobserve d ~ normal(y, sd = 1)\n";
  CHECK(refused_model(open).find("error[E3005]") != std::string::npos);
}

TEST_CASE("initial values off a constraint, or off its time derivative, are refused; those on it for every parameter are not") {
  auto const with_initial = [](std::string const& values) {
    return refused_model("state x, y, pull\nparameter l ~ log_uniform(1, 2)\ninitial " + values +
                         "\nx'' = -pull*x\ny'' = -pull*y - 9.81\nx^2 + y^2 = l^2\nobserve d ~ normal(x, sd = 1)\n");
  };
  CHECK(with_initial("x = l*sin(0.3), y = -l*cos(0.3), x' = 0, y' = 0") == "");
  CHECK(with_initial("x = 0.8*l, y = -0.6*l, x' = 0.3, y' = 0.4") == "");
  CHECK(with_initial("x = 0.8, y = -0.6, x' = 0, y' = 0").find("error[E3017]") != std::string::npos);
  CHECK(with_initial("x = 0.8*l, y = -0.6*l, x' = 1, y' = 0").find("error[E3017]") != std::string::npos);
}

TEST_CASE("in discrete time a step back that is implicit is solved in silence, and a state without a past is warned of") {
  std::string const rest = "parameter a ~ uniform(0, 1)\nobserve d ~ normal(u, sd = 1)\n";
  std::string const start = "time discrete 1 [s]\ninput x\nstate u\ninitial u = 0\n";
  CHECK(refused_model(start + "u = lag(u, 1) + a*(x - u)\n" + rest).empty());
  CHECK(refused_model(start + "u - lag(u, 1) = a*u + x\n" + rest).empty());
  CHECK(refused_model(start + "u = a*u + x\n" + rest).find("warning[E3114]") != std::string::npos);
  CHECK(refused_model("time discrete 1 [s]\ninput x\nstate u, v\ninitial u = 0, v = 0\nu = a*u + x\nv - lag(u, 1) = 0\n" + rest +
                      "observe e ~ normal(v, sd = 1)\n")
            .empty());  // on the left side of another equation
}

TEST_CASE("an initial value of what the equations give is warned of where they contradict it, and only there") {
  auto const said = [](std::string const& given) {
    return refused_model("state y [m], F [N]\nparameter k [N/m] ~ log_uniform(10, 1000)\ninitial y = 0.1, y' = 0, F = " + given +
                         "\nF = k*y\n1 [kg]*y'' + F = 0\nobserve d ~ normal(y, sd = 0.01)\n");
  };
  CHECK(said("5").find("warning[E3021]") != std::string::npos);
  CHECK(said("2*k*0.1 [m]").find("warning[E3021]") != std::string::npos);
  CHECK(said("k*0.1 [m]").empty());
  CHECK(said("k*0.09999 [m]").empty());  // rounded
  CHECK(said("0").empty());              // a place holder
  CHECK(refused_model("input x [N]\nstate y [m], F [N]\nparameter k [N/m] ~ log_uniform(10, 1000)\n"
                      "initial y = 0.1, y' = 0, F = 5\nF = k*y + x\n1 [kg]*y'' + F = 0\nobserve d ~ normal(y, sd = 0.01)\n")
            .empty());  // depends on the record
}
