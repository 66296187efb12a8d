// The tolerance guard on targets whose optimum depends on the solver in a known way.
#include "diagnostics/tolerance.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "inference/targets.hpp"
#include "search/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// N(x | centre, 0.1^2) under a wide prior, with as many residual rows as a long record has.
std::unique_ptr<Target> centred(double centre, int rows = 1) {
  return std::make_unique<TestTarget>(std::vector<std::string>{"x"}, std::vector<Prior>{{Prior::normal, 0, 10}}, rows, 0,
                                      [=](std::vector<double> const& w, std::vector<double>& out) {
                                        std::fill(out.begin(), out.end(), 0.0);
                                        out[0] = (w[0] - centre) / 0.1;
                                      });
}

RefinedSolver settled(std::function<double(int substeps)> const& centre, int rows) {
  Bench bench;
  SolverSettings const from;
  std::vector<Mode> modes = search(*centred(centre(from.substeps)), ObjectiveKind::posterior, bench.context).modes;
  MakeTarget const make = [&](SolverSettings const& solver) { return centred(centre(solver.substeps), rows); };
  return find_converged_solver(make, ObjectiveKind::posterior, from, std::move(modes), bench.context);
}

constexpr int short_record = 10, long_record = 200'000;

}  // namespace

TEST_CASE("a solver is refined until halving its step moves nothing any more, however long that takes") {
  for (int const rows : {short_record, long_record}) {
    // 3 sd between one step and two, a quarter of it each time: 0.19 sd, then 0.05.
    RefinedSolver const found = settled([](int substeps) { return 0.4 / std::pow(substeps, 2); }, rows);
    CHECK(found.converged);
    CHECK(found.solver.substeps == 8);
  }
}

TEST_CASE("a result that moves at every halving is tried to the finest, unless that takes long") {
  auto const restless = [](int substeps) { return static_cast<int>(std::log2(substeps)) % 2 == 0 ? 0.0 : 0.3; };
  RefinedSolver const quick = settled(restless, short_record), slow = settled(restless, long_record);
  CHECK(!quick.converged);
  CHECK(!quick.given_up);
  CHECK(quick.solver.substeps == 256);
  CHECK(!slow.converged);
  CHECK(slow.given_up);
  CHECK(slow.solver.substeps < 64);
}
