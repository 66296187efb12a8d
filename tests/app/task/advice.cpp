// Advice on solver and motion: each row where its reason stands behind the finding, and not elsewhere.
#include "app/fit/advice.hpp"

#include <doctest/doctest.h>

#include "app/search/solver_refinement.hpp"
#include "load/load.hpp"

using namespace sysid;

namespace {

Model advised_rig(std::string const& force) {
  Source source("rig.sysid",
                "model rig {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n parameter F [N] ~ log_uniform(1, 10)\n"
                "1 [kg]*y'' + 1e4 [N/m]*y + " +
                    force + " = x\n observe d ~ normal(y, sd = 1e-5)\n}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE(file);
  return file->models.front();
}

Finding advised(FindingCode code, std::string const& force, SolverSettings const& solver, Ledger const& ledger,
                SearchSolver const* search = nullptr) {
  Model const model = advised_rig(force);
  std::vector<ExperimentData> const data;
  Finding finding{code, Severity::error, {}, "it failed", "look"};
  advise({model, data, solver, ledger, search}, finding);
  return finding;
}

Ledger out_of_steps() {
  Ledger ledger;
  ledger.add_solves(2);
  ledger.add_failure(FailureClass::step_limit, "the solver", 0, {}, 2);
  return ledger;
}

constexpr char const* smooth = "F*tanh(y'/1 [mm/s])";
constexpr char const* dry = "F*sign(y')";

}  // namespace

TEST_CASE("a search without a finite start is told of other solvers, of stiffness, and of sticking, the surest last") {
  Finding const other = advised(FindingCode::no_finite_start, smooth, {}, {});
  CHECK(other.help.starts_with("look; or let the solver choose its steps"));
  CHECK(other.message == "it failed");

  SearchSolver stiff{SolverSettings{}};
  stiff.failed = 0.6;
  stiff.tried = 8, stiff.followed = 7;
  Finding const implicit = advised(FindingCode::no_finite_start, smooth, {}, {}, &stiff);
  CHECK(implicit.message.find("it failed; 60 % of the prior draws overflow") == 0);
  CHECK(implicit.help.starts_with("fit with `solver = "));
  stiff.followed = 1;
  CHECK(advised(FindingCode::no_finite_start, smooth, {}, {}, &stiff).message == "it failed");
  CHECK(stiff_prior(stiff).empty());

  Finding const sticks = advised(FindingCode::no_finite_start, dry, {}, out_of_steps());
  CHECK(sticks.help.find("`tanh(y'/vs)`") != std::string::npos);
  CHECK(advised(FindingCode::no_finite_start, smooth, {}, out_of_steps()).help.find("tanh") == std::string::npos);
  CHECK(advised(FindingCode::no_finite_start, dry, {}, {}).help.find("tanh") == std::string::npos);  // it fails for another reason
}

TEST_CASE("a result that no step settles is sent to smooth friction where the motion sticks, and findings of other kinds stay") {
  CHECK(advised(FindingCode::step_not_settled, dry, {}, {}).help.find("`tanh(y'/vs)`") != std::string::npos);
  CHECK(advised(FindingCode::step_not_settled, smooth, {}, {}).help == "look");
  CHECK(advised(FindingCode::at_bound, dry, {}, out_of_steps()).help == "look");
  // A search that stalls among simulations that run out of steps is not sent to a more accurate solver.
  CHECK(advised(FindingCode::optimum_not_reached, dry, {}, out_of_steps()).help.find("`tanh(y'/vs)`") != std::string::npos);
  CHECK(advised(FindingCode::optimum_not_reached, smooth, {}, out_of_steps()).help == "look");
  CHECK(advised(FindingCode::optimum_not_reached, dry, {}, {}).help == "look");
}
