// Selection by distance among candidates whose states are random: the sizes of what is simulated in closed form, and the same bytes
// however it runs.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "app/running.hpp"
#include "app/selection/candidate.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"

using namespace sysid;

namespace {

/// x' = w from x(0) ~ normal(0, s), seen 40 times at steps of 0.1 s; the record is 0 but for what makes it vary.
std::string const walk = R"(
model walk {
  state x
  parameter q [1/s] ~ log_uniform(0.999, 1.001)
  parameter s ~ log_uniform(1.999, 2.001)
  initial x ~ normal(0, sd = s)
  disturbance w [1/s] ~ white(intensity = q)
  x' = w
  observe m ~ normal(x, sd = 1)
}
model rest {
  state x
  initial x = 0
  parameter a [1/s] ~ log_uniform(0.9, 1.1)
  x' = -a*x
  observe m ~ normal(x, sd = 1)
}
data d { file "d.csv"; time t [s]; measure m = m }
candidates both { walk; rest }
s = select both to d with abc_smc(particles = 100, populations = 2), distance = rmse, seed = 1
)";

std::string flat_record() {
  std::string text = "t,m\n";
  for (int i = 0; i < 40; ++i) text += fmt::format("{},{}\n", 0.1 * i, i % 2 == 0 ? 1e-6 : -1e-6);
  return text;
}

struct DrawnDistances {
  std::vector<double> all;
  std::vector<Simulated> ending;
};

DrawnDistances distances_of(std::string const& text, int threads, int lanes, int width, double bound = infinity) {
  TemporaryFolder folder;
  write_file(folder.path() / "d.csv", flat_record());
  Source source((folder.path() / "case.sysid").string(), text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  RunOptions options;
  options.execution.threads = threads;
  options.execution.lanes = lanes;
  SilentProgress silent;
  std::ostream nowhere(nullptr);
  Session session(source, *file, options, silent, nowhere, nowhere);
  SelectTask const& what = std::get<SelectTask>(file->tasks[0].what);
  auto const candidates = prepare_candidates(session, what, file->candidates[static_cast<std::size_t>(what.candidates)]);
  ModelSelectionTarget const target = selection_target(session, what, candidates, false);
  LaneArray theta(target.dimension(0), width);
  target.sample_prior(0, {7, Purpose::prior, 0, 0}, theta);
  DrawnDistances result{std::vector<double>(static_cast<std::size_t>(width)),
                        std::vector<Simulated>(static_cast<std::size_t>(width))};
  SelectionTarget::Batch const batch{0, theta, result.all, result.ending};
  target.distances({&batch, 1}, bound);
  return result;
}

}  // namespace

TEST_CASE("simulations of a random walk from a random start have its variance") {
  DrawnDistances const found = distances_of(walk, 1, 0, 4000);
  double sum = 0, squares = 0;
  for (double const distance : found.all) {
    sum += distance * distance;
    squares += std::pow(distance, 4);
  }
  double const mean = sum / 4000, error = std::sqrt((squares / 4000 - mean * mean) / 4000);
  // The mean over the samples of s^2 + q t.
  double const expected = 4 + 0.1 * 39 / 2;
  INFO(mean << " +- " << error);
  CHECK(std::abs(mean - expected) < 4 * error);
  CHECK(error < 0.05 * expected);
}

TEST_CASE("distances of random states are the same bytes for any threads and lanes, and grow to a bound") {
  DrawnDistances const one = distances_of(walk, 1, 1, 50), many = distances_of(walk, 3, 8, 50);
  CHECK(one.all == many.all);
  // A lane does not depend on those beside it.
  DrawnDistances const fewer = distances_of(walk, 1, 0, 20);
  CHECK(std::vector<double>(one.all.begin(), one.all.begin() + 20) == fewer.all);
  double const bound = one.all[0];
  DrawnDistances const bounded = distances_of(walk, 1, 0, 50, bound);
  for (std::size_t i = 0; i < 50; ++i) {
    CHECK(bounded.ending[i] == (one.all[i] <= bound ? Simulated::within : Simulated::beyond));
    CHECK(bounded.all[i] == (one.all[i] <= bound ? one.all[i] : infinity));
  }
}

TEST_CASE("a selection by distance runs with candidates whose states are random, and says the same for any threads") {
  auto const run = [](int threads) {
    TemporaryFolder folder;
    write_file(folder.path() / "d.csv", flat_record());
    RunOptions options;
    options.output = folder.path() / "results";
    options.execution.threads = threads;
    run_text(folder.path() / "case.sysid", with(walk, "abc_smc(particles = 100", "abc_smc(cross_check = no, particles = 100"),
             options);
    return read_file(folder.path() / "results/s/particles_walk.csv") + read_file(folder.path() / "results/s/summary.json");
  };
  std::string const one = run(1);
  CHECK(one.size() > 1000);
  CHECK(one == run(2));
}
