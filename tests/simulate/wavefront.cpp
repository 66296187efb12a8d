// Lanes that are given up: those that stay end with the bytes of an undisturbed run, those that leave are the right ones, and
// neither depends on who else is there.
#include "simulate/wavefront.hpp"

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>

#include "core/numeric/random.hpp"
#include "simulate/experiments.hpp"
#include "simulate/systems.hpp"

using namespace sysid;

namespace {

/// Duffing's residual sum alone.
SimulationSource squared_residuals(std::string const& integrator) {
  SimulationSource source = systems::duffing();
  source.channels[0].sums = {source.channels[0].sums[1]};
  source.integrator = integrator;
  return source;
}

Experiment record() {
  return testing::experiment(testing::uniform_times(400, 0.001),
                             {[](double t) { return 10 * std::sin(300 * t) + 5 * std::cos(77 * t); }},
                             {[](double t) { return 1e-4 * std::sin(90 * t); }});
}

/// Wide enough that some lanes diverge.
LaneArray parameters(int width) {
  double const centre[] = {1, 20, 1e4, 5e9, 1e8};
  LaneArray result(5, width);
  for (int w = 0; w < width; ++w) {
    Stream stream({.seed = 3, .purpose = Purpose::test, .index = static_cast<std::uint64_t>(w), .step = 0});
    for (int r = 0; r < 5; ++r) result(r, w) = centre[r] * (1 + 0.3 * stream.normal());
    if (w % 7 == 3) result(3, w) = -1e14;
  }
  return result;
}

struct Wavefront {
  LaneArray sums;
  std::vector<Ending> endings;
  std::vector<int> failed_at;
};

Wavefront run_wavefront(Simulator const& simulator, ConstLanes parameters, double bound, ThreadPool* pool = nullptr) {
  auto const width = static_cast<std::size_t>(parameters.width());
  Wavefront result{LaneArray(1, parameters.width()), std::vector<Ending>(width), std::vector<int>(width)};
  Work const work = wavefront_work(
      simulator, parameters, [bound](ConstLanes sums, int column, int) { return sums(0, column) <= bound; }, result.sums,
      result.endings, result.failed_at);
  do_work({&work, 1}, pool);
  return result;
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

}  // namespace

TEST_CASE("lanes within the bound end with the bytes of an undisturbed run, all others leave") {
  int const width = 333;
  LaneArray const theta = parameters(width);
  for (std::string const integrator : {"rk4", "dopri5"}) {
    auto const program = std::make_shared<SimulationProgram const>(compile(squared_residuals(integrator)));
    SolverSettings settings;
    settings.method = integrator;
    Simulator const simulator(program, Schedule(*program, record(), settings));
    LaneArray whole(1, width);
    std::vector<Outcome> outcome(width);
    simulator.sums(theta, whole, outcome);
    std::vector<double> finite;
    for (int w = 0; w < width; ++w)
      if (outcome[static_cast<std::size_t>(w)].ok) finite.push_back(whole(0, w));
    std::sort(finite.begin(), finite.end());
    REQUIRE(finite.size() > 100);
    REQUIRE(finite.size() < width);
    double const bound = finite[finite.size() / 3];
    Wavefront const bounded = run_wavefront(simulator, theta, bound);
    int finished = 0;
    for (int w = 0; w < width; ++w) {
      auto const i = static_cast<std::size_t>(w);
      bool const within = outcome[i].ok && whole(0, w) <= bound;
      CHECK((bounded.endings[i] == Ending::finished) == within);
      if (within) CHECK(bits(bounded.sums(0, w)) == bits(whole(0, w)));
      finished += within ? 1 : 0;
    }
    CHECK(finished > 30);
  }
}

TEST_CASE("without a bound every lane that stays finite finishes, and those that do not are failed") {
  int const width = 100;
  auto const program = std::make_shared<SimulationProgram const>(compile(squared_residuals("rk4")));
  Simulator const simulator(program, Schedule(*program, record(), {.substeps = 1}));
  LaneArray const theta = parameters(width);
  LaneArray whole(1, width);
  std::vector<Outcome> outcome(width);
  simulator.sums(theta, whole, outcome);
  Wavefront const all = run_wavefront(simulator, theta, std::numeric_limits<double>::infinity());
  for (int w = 0; w < width; ++w) {
    auto const i = static_cast<std::size_t>(w);
    CHECK(all.endings[i] == (outcome[i].ok ? Ending::finished : Ending::failed));
    CHECK((all.failed_at[i] >= 0) == !outcome[i].ok);
  }
}

TEST_CASE("a state that overflows within the last samples fails its lane, though no sum reads it") {
  SimulationSource source = squared_residuals("rk4");
  Graph& g = source.graph;
  source.initial.push_back(g.constant(1));
  source.derivative.push_back(g.multiply(g.constant(1920), g.leaf(LeafKind::state, 2)));  // exp(1920 t) overflows at 0.37 of 0.4 s
  source.records.push_back(g.leaf(LeafKind::state, 2));
  auto const program = std::make_shared<SimulationProgram const>(compile(source));
  Simulator const simulator(program, Schedule(*program, record(), {.substeps = 1}));
  LaneArray theta(5, 1);
  for (int r = 0; r < 5; ++r) theta(r, 0) = std::array{1.0, 20.0, 1e4, 5e9, 1e8}[static_cast<std::size_t>(r)];
  LaneArray whole(1, 1);
  std::vector<Outcome> outcome(1);
  simulator.sums(theta, whole, outcome);
  CHECK_FALSE(outcome[0].ok);
  CHECK(run_wavefront(simulator, theta, std::numeric_limits<double>::infinity()).endings[0] == Ending::failed);
}

TEST_CASE("the ending of a lane depends on that lane alone: widths of blocks, threads and neighbours change nothing") {
  int const width = 500;
  LaneArray const theta = parameters(width);
  auto const program = std::make_shared<SimulationProgram const>(compile(squared_residuals("rk4")));
  Simulator const reference(program, Schedule(*program, record(), {.substeps = 1}), {.lanes = 4, .threads = 1});
  double const bound = 2e-7;
  Wavefront const expected = run_wavefront(reference, theta, bound);
  auto const equal = [&](Wavefront const& other, int first) {
    bool same = true;
    for (int w = 0; w < other.sums.width(); ++w) {
      auto const i = static_cast<std::size_t>(w), j = static_cast<std::size_t>(first + w);
      same = same && other.endings[i] == expected.endings[j] && other.failed_at[i] == expected.failed_at[j] &&
             bits(other.sums(0, w)) == bits(expected.sums(0, first + w));
    }
    return same;
  };
  for (int const lanes : {0, 8, 16, 64})
    for (int const threads : {1, 3}) {
      ExecutionOptions const options{lanes, threads};
      auto const pool = make_pool(options);
      Simulator const simulator(program, Schedule(*program, record(), {.substeps = 1}), options, pool);
      CHECK(equal(run_wavefront(simulator, theta, bound, pool.get()), 0));
    }
  CHECK(equal(run_wavefront(reference, theta.view().columns(123, 45), bound), 123));
}
