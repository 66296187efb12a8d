// Differential-algebraic and implicit models from their text to trajectories: against closed forms, and one solver against another.
#include <doctest/doctest.h>

#include <cmath>

#include "check/checking.hpp"
#include "likelihood/output.hpp"
#include "likelihood/trajectory.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const pendulum = R"(
model pendulum {
  state x [m], y [m], pull [N]
  parameter g [m/s^2] ~ log_uniform(1, 100)
  parameter l [m] ~ log_uniform(0.1, 10)
  constant m [kg] = 0.5
  initial x = l*sin(1.2), y = -l*cos(1.2), x' = 0, y' = 0
  m*x'' = -pull*x/l
  m*y'' = -pull*y/l - m*g
  x^2 + y^2 = l^2
  observe position ~ normal(x, sd = 0.1)
  observe rod ~ normal(pull, sd = 0.1)
  observe speed ~ normal(y', sd = 0.1)
  observe height ~ normal(y, sd = 0.1)
}
)";

std::string braking(std::string const& guess) {
  return "model braking {\nstate v\nparameter a ~ log_uniform(0.1, 10)\ninitial v = 9, v' = " + guess +
         "\n(v')^2 = a*v\nobserve speed ~ normal(v, sd = 0.1)\nobserve rate ~ normal(v', sd = 0.1)\n}\n";
}

struct Predicted {
  std::shared_ptr<CompiledModel const> compiled;
  Trajectory::Result result;
};

Predicted predict(std::string const& text, SolverSettings const& solver, std::vector<double> const& parameters, int samples,
                  double step) {
  Predicted predicted{compile(checked(text).models.front(), false, solver.method), {}};
  Experiment experiment;
  for (int i = 0; i < samples; ++i) experiment.time.push_back(step * i);
  experiment.scored.assign(experiment.time.size(), 1);
  experiment.measured.resize(predicted.compiled->model.channels.size());
  LaneArray values(static_cast<int>(parameters.size()), 1);
  for (std::size_t p = 0; p < parameters.size(); ++p) values(static_cast<int>(p), 0) = parameters[p];
  predicted.result = Trajectory(predicted.compiled, experiment, solver, 0, {}).run(values, {});
  return predicted;
}

}  // namespace

TEST_CASE("a pendulum in Cartesian coordinates: IDA with the rod's force as unknown and RK4 without agree") {
  double const g = 9.81, l = 0.8, m = 0.5;
  Predicted const ida = predict(pendulum, {.method = "ida", .relative = 1e-10}, {g, l}, 101, 0.02);
  Predicted const rk4 = predict(pendulum, {.substeps = 40}, {g, l}, 101, 0.02);
  Predicted const cvode = predict(pendulum, {.method = "cvode", .relative = 1e-10}, {g, l}, 101, 0.02);
  CHECK(ida.result.failed() == 0);
  for (std::size_t i = 0; i < 101; ++i) {
    for (std::size_t channel = 0; channel < 4; ++channel) {
      double const expected = rk4.result.values[channel][0][i];
      CHECK(std::abs(ida.result.values[channel][0][i] - expected) < 1e-6);
      CHECK(std::abs(cvode.result.values[channel][0][i] - expected) < 1e-6);
    }
    // Energy: v^2 = 2 g (y0 - y), so pull = m (v^2 - g y)/l = m g (2 y0 - 3 y)/l.
    double const y0 = -l * std::cos(1.2), y = ida.result.values[3][0][i];
    CHECK(std::abs(ida.result.values[1][0][i] - m * g * (2 * y0 - 3 * y) / l) < 1e-6);
  }
  REQUIRE(ida.result.drift.size() == 1);
  CHECK(ida.result.drift[0][0] > 0);
  CHECK(ida.result.drift[0][0] < 1e-7);
  CHECK(rk4.result.drift[0][0] < 1e-9);
  CHECK(predict(pendulum, {.substeps = 1}, {g, l}, 101, 0.2).result.drift[0][0] > 1e-3);
}

TEST_CASE("an implicit equation follows the branch of its guess") {
  // sqrt(v) = 3 -+ sqrt(a) t/2.
  for (double const sign : {-1.0, 1.0}) {
    Predicted const found = predict(braking(sign < 0 ? "-1" : "0.1"), {.method = "ida", .relative = 1e-10}, {2}, 21, 0.1);
    REQUIRE(found.result.failed() == 0);
    for (std::size_t i = 0; i < 21; ++i) {
      double const root = 3 + sign * std::sqrt(2.0) * 0.1 * static_cast<double>(i) / 2;
      CHECK(found.result.values[0][0][i] == doctest::Approx(root * root).epsilon(1e-7));
      CHECK(found.result.values[1][0][i] == doctest::Approx(sign * std::sqrt(2.0) * root).epsilon(1e-7));
    }
  }
}

TEST_CASE("a parameter that only an implicit equation reads shapes the response") {
  auto const roles = parameter_roles(checked(braking("-1")).models.front());
  REQUIRE(roles.size() == 1);
  CHECK(roles[0] == ParameterRole::response);
}

TEST_CASE("an implicit equation without a solution at the start is a failed solve") {
  Predicted const none = predict(braking("-1"), {.method = "ida"}, {-2}, 5, 0.1);
  CHECK(none.result.failed() == 1);
  CHECK(none.result.ledger.solves() == 1);
}

TEST_CASE("states of the program behind those of the model have the names of what they stand for") {
  auto const said_of_state = [](Model const& model, std::size_t behind) {
    Source const source("case.sysid", "");
    Graph graph = model.graph;
    NodeId const state = graph.leaf(LeafKind::state, static_cast<int>(model.states.size() + behind));
    NodeId const root = graph.unary(Operation::square_root, state);
    return describe(model, graph, root, source);
  };
  Model const swinging = checked(pendulum).models.front();
  REQUIRE_FALSE(swinging.unknowns.empty());
  CHECK(said_of_state(swinging, 0) == "`sqrt(" + swinging.unknowns[0].name + ")`");
  CHECK(said_of_state(model_of("state x\ninitial x = 1\nparameter a ~ log_uniform(1, 2)\nx' = -a*x\n"
                               "observe moved ~ normal(since_last(x), sd = 0.1)"),
                      0) == "`sqrt(the value before)`");
  CHECK(said_of_state(model_of("state x\ninitial x ~ normal(0, sd = 1)\nparameter a ~ log_uniform(1, 2)\nx' = -a*x\n"
                               "observe o ~ normal(x, sd = 0.1)"),
                      0) == "`sqrt(a covariance)`");
}

TEST_CASE("what the compiler made of a constraint is named with the constraint it was made of") {
  Source source("pendulum.sysid", pendulum);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE(file);
  Model const& model = file->models.front();
  int of_the_constraint = 0;
  for (NodeId const node : model.graph.reachable(model.residuals)) {
    if (model.graph.span(node) || model.graph[node].operation == Operation::leaf ||
        model.graph[node].operation == Operation::constant)
      continue;
    std::string const text = describe(model, model.graph, node, source);
    CAPTURE(text);
    CHECK(text.find("` in `") != std::string::npos);
    CHECK(text.find("(pendulum.sysid:") != std::string::npos);
    if (text.find("in `x^2 + y^2 = l^2` (pendulum.sysid:10:3)") != std::string::npos) ++of_the_constraint;
  }
  CHECK(of_the_constraint > 0);
}
