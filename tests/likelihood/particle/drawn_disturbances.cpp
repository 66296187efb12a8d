// Disturbances that simulations draw: the motion that they cause has the variance that white noise gives it.
#include "likelihood/particle/drawn_disturbances.hpp"

#include <doctest/doctest.h>

#include "core/numeric/statistics.hpp"
#include "likelihood/particle/cases.hpp"
#include "likelihood/trajectory.hpp"
#include "model/replaced_disturbances.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Variance of a force of unit variance whose correlation dies off within a quarter of a sampling interval, from 20,000 samples.
double variance_with(int pieces) {
  Model model = parsed_model(R"(
model gust {
  input e
  state w
  initial w = 0
  parameter size ~ log_uniform(0.1, 10)
  w' = -w/0.25 + e
  observe force ~ normal(w, sd = 1)
}
)");
  disturb(model, "size");
  Experiment experiment;
  experiment.name = "record";
  for (int i = 0; i < 20000; ++i) experiment.time.push_back(i);
  experiment.measured = {std::vector<double>(20000, 0.0)};
  experiment.scored.assign(20000, 1);
  LaneArray parameters(1, 1);
  parameters(0, 0) = std::sqrt(2 / 0.25);
  DrawnDisturbances drawn = draw_disturbances(std::move(model), parameters, std::move(experiment), {.seed = 3}, pieces);
  SolverSettings solver;
  solver.substeps = 16;
  auto const compiled = compile(std::move(drawn.model), false, solver.method);
  Trajectory const trajectory(compiled, drawn.experiment, solver, 0, {});
  return population_variance(trajectory.run(parameters, {.seed = 4}).values[0][0]);
}

}  // namespace

TEST_CASE("drawn disturbances: motion that is fast against the sampling has its variance where noise has pieces enough") {
  CHECK(variance_with(16) == doctest::Approx(1).epsilon(0.03));
  CHECK(variance_with(8) == doctest::Approx(1).epsilon(0.03));
  CHECK(variance_with(1) == doctest::Approx(0.9).epsilon(0.03));
}

TEST_CASE("a disturbance is replaced wherever a model reads it") {
  Model model;
  Graph& graph = model.graph;
  NodeId const w = graph.leaf(LeafKind::disturbance, 0), x = graph.leaf(LeafKind::state, 0), u = graph.leaf(LeafKind::input, 0);
  model.disturbances.emplace_back();
  model.states.emplace_back().derivative = graph.add(x, w);
  model.memories = {graph.multiply(x, w)};
  model.derived.emplace_back().value = w;
  model.lagged_quantities.emplace_back().present = w;
  model.channels.emplace_back().noise.arguments = {w, x};
  model.channels.front().noise.upper = w;
  replace_disturbances(model, std::vector<NodeId>{u});
  CHECK(model.disturbances.empty());
  CHECK(model.states.front().derivative == graph.add(x, u));
  CHECK(model.memories.front() == graph.multiply(x, u));
  CHECK(model.derived.front().value == u);
  CHECK(model.lagged_quantities.front().present == u);
  CHECK(model.channels.front().noise.arguments == std::vector<NodeId>{u, x});
  CHECK(*model.channels.front().noise.upper == u);
}
