// Populations against answers in closed form: model probabilities, spreads within a threshold, weights of every kernel; stops,
// deaths, degenerate cases; and the same bytes for any batches, threads and interruptions.
#include "inference/abc/abc_smc.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "inference/abc/kernel.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/selection_toys.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

/// As it comes back from a file.
std::shared_ptr<nlohmann::json const> kept(nlohmann::json const& state) {
  return std::make_shared<nlohmann::json const>(nlohmann::json::from_cbor(nlohmann::json::to_cbor(state)));
}

using testing::Prior;
using testing::size_of_first;
using testing::Toy;
using testing::two_widths;

Settings with(std::initializer_list<std::pair<char const*, SettingValue>> values) { return testing::abc_settings(values); }

SelectionResult run(SelectionTarget const& toy, Settings const& settings, std::uint64_t seed = 1, Ledger* counts = nullptr) {
  SilentProgress silent;
  Ledger ledger;
  RunContext context{seed, silent, counts != nullptr ? *counts : ledger, {}, {}, 60, {}, {}, {}};
  return abc::run(toy, settings, context);
}

bool has(Findings const& findings, std::string const& code) {
  return std::any_of(findings.begin(), findings.end(), [&](Finding const& f) { return word(f.code) == code; });
}

}  // namespace

TEST_CASE("weights give the exact model probability 10/11 in every population, shares of particles do not") {
  Toy const toy = two_widths();
  // One after another, thresholds from 1 down: all that changes is how far the kernels reach.
  Settings const settings = with({{"particles", std::int64_t{4000}},
                                  {"schedule", std::vector<double>{1, 0.7, 0.5, 0.35, 0.25, 0.18, 0.13, 0.09, 0.06, 0.04}}});
  SelectionResult const result = run(toy, settings);
  REQUIRE_FALSE(result.failure);
  REQUIRE(result.populations.size() == 10);
  for (std::size_t t = 0; t < 10; ++t) {
    CAPTURE(t);
    CHECK(std::fabs(result.populations[t].models[0].probability - 10.0 / 11) < 0.02);
    if (t >= 1) CHECK(result.populations[t].share(0) < 0.8);  // models are proposed alike, so they fill alike
  }
  CHECK(result.populations[9].share(0) == doctest::Approx(0.5).epsilon(0.1));
}

TEST_CASE("the same with models drawn from the last population, whose kernel has its place in the weight") {
  Toy const toy = two_widths();
  Settings const settings = with({{"particles", std::int64_t{4000}},
                                  {"model_kernel", std::string("previous")},
                                  {"schedule", std::vector<double>{1, 0.5, 0.25, 0.13, 0.06, 0.03}}});
  SelectionResult const result = run(toy, settings, 2);
  for (PopulationRecord const& population : result.populations)
    CHECK(std::fabs(population.models[0].probability - 10.0 / 11) < 0.03);
}

TEST_CASE("prior probabilities of models take part: 1/11 against 10/11 makes the two widths equal") {
  Toy const toy({{"narrow", 1.0 / 11, {{Prior::uniform, -1, 1}}, size_of_first},
                 {"wide", 10.0 / 11, {{Prior::uniform, -10, 10}}, size_of_first}});
  SelectionResult const result =
      run(toy, with({{"particles", std::int64_t{4000}}, {"schedule", std::vector<double>{1, 0.5, 0.2, 0.1}}}));
  for (PopulationRecord const& population : result.populations) CHECK(std::fabs(population.models[0].probability - 0.5) < 0.035);
}

TEST_CASE(
    "every kernel, in either coordinates, leaves the same posterior: uniform within the threshold, whatever the prior's width") {
  // Two parameters, distance max |p|: the posterior is uniform on the square, sd eps/sqrt(3), no correlation.
  Toy const toy({{"square", 1, {{Prior::uniform, -1, 3}, {Prior::uniform, -20, 5}}, [](std::span<double const> p) {
                    return std::max(std::fabs(p[0]), std::fabs(p[1]));
                  }}});
  for (std::string const kernel : {"gaussian", "component_gaussian", "uniform", "nearest_neighbours"})
    for (std::string const coordinates : {"natural", "declared", "unconstrained"}) {
      CAPTURE(kernel);
      CAPTURE(coordinates);
      SelectionResult const result = run(toy, with({{"particles", std::int64_t{2000}},
                                                    {"kernel", kernel},
                                                    {"coordinates", coordinates},
                                                    {"schedule", std::vector<double>{5, 2, 0.8, 0.4, 0.2}}}));
      REQUIRE_FALSE(result.failure);
      double const sd = 0.2 / std::sqrt(3.0), ess = result.populations.back().ess;
      REQUIRE(ess > 500);
      for (WeightedSummary const& summary : result.models[0].summaries) {
        CHECK(std::fabs(summary.mean) < 4.5 * sd / std::sqrt(ess));
        // The sd of an sd of a uniform density: sd sqrt((kurtosis - 1)/4n), kurtosis 9/5.
        CHECK(std::fabs(summary.sd - sd) < 4.5 * sd * std::sqrt(0.2 / ess));
        CHECK(summary.q5 == relative(-0.18, 0.1));
      }
    }
}

TEST_CASE("a log-uniform prior keeps its density: the posterior of a threshold on the value itself") {
  // p ~ log_uniform(1e-3, 1), distance p: p within (1e-3, eps) log-uniform: median sqrt(1e-3 eps).
  Toy const toy({{"decade", 1, {{Prior::log_uniform, 1e-3, 1}}, [](std::span<double const> p) { return p[0]; }}});
  for (std::string const coordinates : {"natural", "declared", "unconstrained"}) {
    SelectionResult const result = run(
        toy,
        with({{"particles", std::int64_t{2000}}, {"coordinates", coordinates}, {"schedule", std::vector<double>{0.5, 0.2, 0.1}}}));
    double const ess = result.populations.back().ess, median = std::log(result.models[0].summaries[0].median);
    // log p is uniform over a width of log 100: sd of a median of n uniform draws is width/(2 sqrt n).
    CHECK(std::fabs(median - 0.5 * std::log(1e-3 * 0.1)) < 4.5 * std::log(100.0) / (2 * std::sqrt(ess)));
  }
}

TEST_CASE("thresholds fall to the quantile of all distances, unweighted, and the run stops at a small change") {
  Toy const toy = two_widths();
  SelectionResult const result = run(toy, with({{"quantile", 0.3}, {"threshold_change", 0.01}, {"relative_change", 0.0}}));
  REQUIRE(result.populations.size() > 3);
  CHECK(result.populations[0].threshold == infinity);
  for (std::size_t t = 2; t < result.populations.size(); ++t) {
    double const fall = result.populations[t - 1].threshold - result.populations[t].threshold;
    CHECK(fall > 0.01);
    // Distances of a population are uniform below its threshold.
    CHECK(result.populations[t].threshold / result.populations[t - 1].threshold == doctest::Approx(0.3).epsilon(0.2));
  }
  CHECK(result.threshold - result.next_threshold <= 0.01);
  CHECK(result.stopped_by.find("the threshold would next decrease by only") != std::string::npos);
}

TEST_CASE("proposals that are simulated ahead, as many ranks do, change nothing") {
  Toy const toy = two_widths();
  // Populations that need tens of thousands of proposals, more than a batch; one run ends at a number of simulations.
  for (double const most : {1e8, 60'000.0}) {
    Settings const settings =
        with({{"particles", std::int64_t{4000}}, {"simulations", most}, {"schedule", std::vector<double>{0.2, 0.02, 0.002}}});
    Ledger alone;
    SelectionResult const expected = run(toy, settings, 1, &alone);
    CHECK(expected.populations.back().proposed > 2 * 8192);
    for (int const at_once : {9000, 20'001, 1'000'000}) {
      CAPTURE(at_once);
      SilentProgress silent;
      Ledger ledger;
      RunContext context{1, silent, ledger, {}, {}, 60, {}, {}, {}};
      SelectionResult const found = abc::run_wide(toy, settings, context, at_once);
      CHECK(ledger.solves() == alone.solves());
      CHECK(found.stopped_by == expected.stopped_by);
      REQUIRE(found.populations.size() == expected.populations.size());
      for (std::size_t t = 0; t < found.populations.size(); ++t) {
        CHECK(found.populations[t].proposed == expected.populations[t].proposed);
        CHECK(found.populations[t].simulated == expected.populations[t].simulated);
      }
      for (std::size_t m = 0; m < found.models.size(); ++m) {
        CHECK(found.models[m].weight == expected.models[m].weight);
        CHECK(found.models[m].distance == expected.models[m].distance);
      }
    }
  }
}

TEST_CASE("a run ends at a target, at its number of populations or simulations, and below an acceptance rate") {
  Toy const toy = two_widths();
  SelectionResult const target = run(toy, with({{"target", 0.01}}));
  CHECK(target.threshold == 0.01);
  CHECK(target.stopped_by.find("target") != std::string::npos);
  SelectionResult const populations = run(toy, with({{"populations", std::int64_t{3}}, {"relative_change", 0.0}}));
  CHECK(populations.populations.size() == 3);
  SelectionResult const simulations = run(toy, with({{"simulations", 5000.0}, {"relative_change", 0.0}}));
  CHECK(simulations.stopped_by.find("simulations = 5000") != std::string::npos);
  CHECK(simulations.populations.back().accepted == 1000);  // the last whole one
  // Normal proposals into a uniform square of a threshold five times smaller: about one in ten is accepted.
  SelectionResult const acceptance = run(toy, with({{"acceptance", 0.5}, {"relative_change", 0.0}}));
  CHECK(acceptance.stopped_by.find("accepted") != std::string::npos);
}

TEST_CASE("a model that cannot come near dies by distance, stays in the table, and is not called unlucky") {
  Toy const toy({{"near", 0.5, {{Prior::uniform, -1, 1}}, size_of_first},
                 {"far", 0.5, {{Prior::uniform, -1, 1}}, [](std::span<double const> p) { return 0.5 + std::fabs(p[0]); }}});
  SelectionResult const result = run(toy, with({{"target", 0.01}}));
  CHECK(result.models[0].died_in == 0);
  CHECK(result.models[0].probability == doctest::Approx(1));
  CHECK(result.models[1].died_in > 1);
  CHECK_FALSE(result.models[1].by_chance);
  CHECK(result.models[1].probability == 0);
  CHECK(result.models[1].summaries.size() == 1);  // of its last particles
  CHECK_FALSE(has(result.findings, "model_lost_by_chance"));
}

TEST_CASE("a model that is as near as the others but hardly proposed dies by chance, which is said") {
  // The rare one is proposed once in 200: in some population none of its proposals is accepted, though its particles were near
  // enough.
  Toy const toy(
      {{"common", 0.995, {{Prior::uniform, -1, 1}}, size_of_first}, {"rare", 0.005, {{Prior::uniform, -1, 1}}, size_of_first}});
  int lost = 0, said = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SelectionResult const result = run(toy, with({{"particles", std::int64_t{200}}, {"target", 1e-4}}), seed);
    if (result.models[1].died_in <= 1) continue;
    ++lost;
    CHECK(result.models[1].by_chance);
    said += has(result.findings, "model_lost_by_chance") ? 1 : 0;
  }
  CHECK(lost > 0);
  CHECK(said == lost);
}

TEST_CASE("a candidate without parameters takes part with all its prior probability while it is near enough") {
  // Within a threshold eps the other one keeps a part eps of its prior: p = 1/(1 + eps).
  Toy const toy(
      {{"fixed", 0.5, {}, [](std::span<double const>) { return 0.01; }}, {"free", 0.5, {{Prior::uniform, -1, 1}}, size_of_first}});
  SelectionResult const result =
      run(toy, with({{"particles", std::int64_t{4000}}, {"schedule", std::vector<double>{0.5, 0.2, 0.1}}}));
  REQUIRE(result.populations.size() == 3);
  for (PopulationRecord const& population : result.populations)
    CHECK(std::fabs(population.models[0].probability - 1 / (1 + population.threshold)) < 0.03);
}

TEST_CASE("degenerate cases end in words") {
  SUBCASE("no draw comes within the first threshold") {
    Toy const toy({{"far", 1, {{Prior::uniform, -1, 1}}, [](std::span<double const>) { return 5.0; }}});
    SelectionResult const result = run(toy, with({{"first_threshold", 1.0}, {"simulations", 20000.0}}));
    REQUIRE(result.failure);
    CHECK(result.failure->code == FindingCode::no_population);
    CHECK(result.failure->message ==
          "0 of 20000 draws from the priors came within the first threshold 1, but the first population needs 1000: "
          "`simulations = 20000` is reached");
    CHECK(result.failure->help.find("raise the first threshold") == 0);
    // The first of a schedule is one as well.
    SelectionResult const scheduled = run(toy, with({{"schedule", std::vector<double>{2, 1}}, {"simulations", 20000.0}}));
    REQUIRE(scheduled.failure);
    CHECK(scheduled.failure->message.find("within the first threshold 2,") != std::string::npos);
  }
  SUBCASE("a budget ends before the first population does") {
    SelectionResult const result = run(two_widths(), with({{"simulations", 10.0}}));
    REQUIRE(result.failure);
    CHECK(result.failure->message ==
          "10 of 10 draws from the priors could be simulated, but the first population needs 1000: `simulations = 10` is reached");
    CHECK(result.failure->help == "raise the limit that was reached (`simulations`, `wall_time`), or use fewer `particles`");
  }
  SUBCASE("nothing can be simulated") {
    Toy const toy({{"broken", 1, {{Prior::uniform, -1, 1}}, [](std::span<double const>) { return std::nan(""); }}});
    Ledger ledger;
    SelectionResult const result = run(toy, with({{"simulations", 5000.0}}), 1, &ledger);
    REQUIRE(result.failure);
    CHECK(ledger.failed() == ledger.solves());
    CHECK(result.failure->message.find("0 of 5000 draws from the priors could be simulated (5000 did not stay finite: ") == 0);
    CHECK(ledger.failures().front().where == "the toy of `broken`");
    CHECK(ledger.failures().front().names == std::vector<std::string>{"p0"});
    CHECK(result.failure->help.find("the priors lie where the models do not stay finite") == 0);
  }
  SUBCASE("a kernel whose moves leave the range of numbers") {
    // A covariance of 1e-12 times 1e-320 is 0, and so is a width of 1e-6 times that.
    Toy const toy({{"small", 1, {{Prior::uniform, -1e-6, 1e-6}, {Prior::uniform, -1e-6, 1e-6}}, size_of_first}});
    for (std::string const kernel : {"gaussian", "component_gaussian", "uniform", "nearest_neighbours"}) {
      CAPTURE(kernel);
      SelectionResult const result = run(
          toy,
          with({{"particles", std::int64_t{100}}, {"kernel", kernel}, {"kernel_scale", 1e-320}, {"populations", std::int64_t{4}}}));
      CHECK_FALSE(result.failure);
      CHECK_FALSE(result.stopped_by.empty());
      CHECK(std::isfinite(result.populations.back().ess));
      CHECK(result.models[0].probability == doctest::Approx(1));
    }
    SelectionResult const lost = run(toy, with({{"kernel", std::string("uniform")}, {"kernel_scale", 1e-320}}));
    CHECK(lost.ran_out);
    CHECK(lost.stopped_by.find("underflow") != std::string::npos);
  }
  SUBCASE("all distances are equal") {
    Toy const toy({{"flat", 1, {{Prior::uniform, -1, 1}}, [](std::span<double const>) { return 0.25; }}});
    SelectionResult const result = run(toy, with({{"relative_change", 0.0}}));
    CHECK_FALSE(result.failure);
    CHECK(has(result.findings, "distances_equal"));
    CHECK(result.threshold == 0.25);
  }
  SUBCASE("half of the prior cannot be simulated") {
    Toy const toy(
        {{"half", 1, {{Prior::uniform, -1, 1}}, [](std::span<double const> p) { return p[0] < 0 ? std::nan("") : p[0]; }}});
    SelectionResult const result = run(toy, with({{"target", 0.01}}));
    CHECK_FALSE(result.failure);
    CHECK(result.populations[0].failed > 300);
    CHECK(has(result.findings, "failed_solves"));
  }
  SUBCASE("a model keeps one particle, and its kernel a width") {
    Toy const toy(
        {{"common", 0.999, {{Prior::uniform, -1, 1}}, size_of_first}, {"rare", 0.001, {{Prior::uniform, -1, 1}}, size_of_first}});
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      SelectionResult const result = run(toy, with({{"particles", std::int64_t{100}}, {"target", 0.01}}), seed);
      CHECK_FALSE(result.failure);
      CHECK(std::isfinite(result.populations.back().ess));
    }
  }
}

TEST_CASE("a move within a box has a density, though rounding takes its place beyond the edge") {
  // About 1e9 numbers are 1.19e-7 apart: a move of more than half of that goes on to the next one, beyond a box of 1.5e-7.
  LaneArray at(1, 1);
  at(0, 0) = 1e9;
  std::vector<double> const weight = {1};
  abc::Plan plan;
  plan.scale = 1;
  auto const kernel = abc::find_kernel("uniform")->make(
      plan, at, weight, {Eigen::MatrixXd::Constant(1, 1, 1e-14), Eigen::VectorXd::Constant(1, 1.5e-7)});
  std::vector<int> const centres(200, 0);
  std::vector<Stream> streams;
  for (std::uint64_t w = 0; w < 200; ++w) streams.emplace_back(StreamKey{1, Purpose::test, w, 0});
  LaneArray moved(1, 200);
  kernel->perturb(centres, streams, moved);
  std::vector<double> density(200);
  kernel->log_density(moved, density);
  int beyond = 0;
  for (int w = 0; w < 200; ++w) beyond += std::fabs(moved(0, w) - 1e9) > 0.75e-7 ? 1 : 0;
  CHECK(beyond > 10);
  for (double const each : density) CHECK(each == doctest::Approx(-std::log(1.5e-7)));
}

TEST_CASE("an interrupted run goes on to the same bytes, within populations and between them") {
  Toy const toy = two_widths();
  Settings const settings = with({{"particles", std::int64_t{3000}}, {"target", 0.01}, {"quantile", 0.1}});
  Ledger whole_ledger;
  SelectionResult const whole = run(toy, settings, 5, &whole_ledger);
  for (int const polls : {0, 1, 3, 6, 10}) {
    CAPTURE(polls);
    SilentProgress silent;
    nlohmann::json stored;
    {
      Ledger ledger;
      int left = polls;
      RunContext context{5,  silent, ledger, [&] { return left-- <= 0; }, [&](nlohmann::json const& state) { stored = state; }, 1e9,
                         {}, {},     {}};
      SelectionResult const part = abc::run(toy, settings, context);
      CHECK(part.interrupted);
    }
    Ledger ledger;
    RunContext context{5, silent, ledger, {}, {}, 60, kept(stored), {}, {}};
    SelectionResult const resumed = abc::run(toy, settings, context);
    REQUIRE(resumed.populations.size() == whole.populations.size());
    CHECK(std::bit_cast<std::uint64_t>(resumed.threshold) == std::bit_cast<std::uint64_t>(whole.threshold));
    CHECK(resumed.models[0].weight == whole.models[0].weight);
    CHECK(resumed.models[1].distance == whole.models[1].distance);
    CHECK(ledger.solves() == whole_ledger.solves());
  }
}

TEST_CASE("a checkpoint of another seed, or one whose populations do not follow each other, is refused") {
  Toy const toy = two_widths();
  Settings const settings = with({{"particles", std::int64_t{300}}, {"target", 0.01}, {"quantile", 0.1}});
  SilentProgress silent;
  Ledger ledger;
  nlohmann::json stored;
  RunContext first{5, silent, ledger, [] { return true; }, [&](nlohmann::json const& state) { stored = state; }, 1e9, {}, {}, {}};
  abc::run(toy, settings, first);
  RunContext other{6, silent, ledger, {}, {}, 60, kept(stored), {}, {}};
  CHECK(abc::run(toy, settings, other).failure);

  int left = 10;
  RunContext later{5,  silent, ledger, [&] { return left-- <= 0; }, [&](nlohmann::json const& state) { stored = state; }, 1e9,
                   {}, {},     {}};
  abc::run(toy, settings, later);
  REQUIRE(stored.at("records").size() > 1);
  auto const failure = [&](nlohmann::json const& state) {
    RunContext context{5, silent, ledger, {}, {}, 60, kept(state), {}, {}};
    auto const found = abc::run(toy, settings, context).failure;
    return found ? found->message : std::string();
  };
  CHECK(failure(stored).empty());
  for (auto const& [pointer, value] : {std::pair<char const*, nlohmann::json>{"/records", nlohmann::json::array()},
                                       {"/records/0/models", nlohmann::json::array()},
                                       {"/record/models", nlohmann::json::array()},
                                       {"/last/number", -1},
                                       {"/next/number", 1},
                                       {"/departures/0/0", 99},
                                       {"/departures/0/0", 1},  // of a model that lives
                                       {"/departures/0/1", true}}) {
    CAPTURE(pointer);
    nlohmann::json forged = stored;
    forged[nlohmann::json::json_pointer(pointer)] = value;
    CHECK_FALSE(failure(forged).empty());
  }
  // All that the model had; what its record counts stays.
  nlohmann::json forged = stored;
  nlohmann::json const nothing = checkpoint::encode(std::span<double const>());
  for (nlohmann::json& each : forged.at("last").at("models").at(0)) each = nothing;
  CHECK(failure(forged).find("its particles are not those that were counted") != std::string::npos);
  forged.at("records").back().at("models").at(0).at(2) = 0;
  CHECK(failure(forged).find("its particles are not those that were counted") != std::string::npos);
}

namespace {

/// Knows what a run is doing: populations are announced, what lies between two of them is weighing.
class Phase : public Progress {
 public:
  void begin(std::string_view, std::uint64_t) override { ++population, simulating = true; }
  void advance(std::uint64_t, std::string_view) override {}
  void end(bool) override { simulating = false; }
  int population = 0;
  bool simulating = false;
};

/// Stops a run at the first poll for which `now` says so, and goes on from what it leaves.
struct Broken {
  nlohmann::json checkpoint;
  SelectionResult part, resumed;
  Ledger ledger;  // of the resumed
};
Broken break_when(SelectionTarget const& toy, Settings const& settings, std::function<bool(Phase const&)> const& now) {
  Broken broken;
  Phase phase;
  Ledger ledger;
  RunContext first{
      5,  phase, ledger, [&] { return now(phase); }, [&](nlohmann::json const& state) { broken.checkpoint = state; }, 1e9,
      {}, {},    {}};
  broken.part = abc::run(toy, settings, first);
  SilentProgress silent;
  RunContext second{5, silent, broken.ledger, {}, {}, 60, kept(broken.checkpoint), {}, {}};
  broken.resumed = abc::run(toy, settings, second);
  return broken;
}

/// [D x W] by row; numbers are compared by `==`: none of them is NaN.
std::vector<double> numbers(LaneArray const& lanes) {
  std::vector<double> all;
  for (int d = 0; d < lanes.rows(); ++d) all.insert(all.end(), lanes.row(d).begin(), lanes.row(d).end());
  return all;
}

void check_same(SelectionResult const& a, Ledger const& of_a, SelectionResult const& b, Ledger const& of_b) {
  REQUIRE(a.populations.size() == b.populations.size());
  CHECK(std::bit_cast<std::uint64_t>(a.threshold) == std::bit_cast<std::uint64_t>(b.threshold));
  REQUIRE(a.models.size() == b.models.size());
  for (std::size_t m = 0; m < a.models.size(); ++m) {
    CHECK(a.models[m].weight == b.models[m].weight);
    CHECK(a.models[m].distance == b.models[m].distance);
    REQUIRE_FALSE(a.models[m].weight.empty());
    CHECK(numbers(a.models[m].theta) == numbers(b.models[m].theta));
    CHECK(numbers(a.models[m].declared) == numbers(b.models[m].declared));
  }
  CHECK(of_a.solves() == of_b.solves());
  REQUIRE(of_a.failures().size() == of_b.failures().size());
  for (std::size_t f = 0; f < of_a.failures().size(); ++f) {
    Failure const &mine = of_a.failures()[f], &other = of_b.failures()[f];
    CHECK(mine.where == other.where);
    CHECK(mine.count == other.count);
    CHECK(mine.example == other.example);
    CHECK(mine.names == other.names);
  }
}

/// Left at a simulation, or at the look at a failed one, by their numbers.
class LeftToy : public Toy {
 public:
  LeftToy(std::vector<OfModel> models, double simulation, double look)
      : Toy(std::move(models)), simulation_(simulation), look_(look) {}
  void distances(std::span<Batch const> batches, double bound) const override {
    for (Batch const& batch : batches) simulated_ += batch.theta.width();
    if (simulated_ >= simulation_) throw Interrupted();
    Toy::distances(batches, bound);
  }
  std::pair<std::string, double> failure(int model, ConstLanes theta) const override {
    if (++looked_ >= look_) throw Interrupted();
    return Toy::failure(model, theta);
  }

 private:
  double simulation_, look_;
  mutable double simulated_ = 0, looked_ = 0;
};

/// |p|, and nothing for a twentieth of the prior: so that a run has failures to remember.
double fails_at_the_edge(std::span<double const> values) { return values[0] > 0.9 ? std::nan("") : std::fabs(values[0]); }

}  // namespace

TEST_CASE("a run interrupted while it weighs keeps the population that is full, and weighs it again") {
  // One model, so that its 5000 particles are weighed in several pieces.
  Toy const toy({{"narrow", 1, {{Prior::uniform, -1, 1}}, fails_at_the_edge}});
  Settings const settings = with({{"particles", std::int64_t{5000}}, {"schedule", std::vector<double>{0.8, 0.3, 0.1}}});
  Ledger ledger;
  SelectionResult const whole = run(toy, settings, 5, &ledger);
  REQUIRE(ledger.failed() > 8);
  Broken const broken = break_when(toy, settings, [](Phase const& phase) { return phase.population == 2 && !phase.simulating; });
  CHECK(broken.part.interrupted);
  CHECK(broken.part.populations.size() == 1);
  REQUIRE(broken.checkpoint.is_object());
  CHECK(broken.checkpoint.at("record").at("counts").at(3) == 5000);  // accepted of the second
  check_same(broken.resumed, broken.ledger, whole, ledger);
}

TEST_CASE("a run whose simulations are given up keeps what was accepted before them") {
  std::vector<Toy::OfModel> models{{"edge", 1, {{Prior::uniform, -1, 1}}, &fails_at_the_edge}};
  Settings const settings = with({{"particles", std::int64_t{3000}}, {"target", 0.01}, {"quantile", 0.1}});
  Ledger whole_ledger;
  SelectionResult const whole = run(Toy(models), settings, 5, &whole_ledger);
  REQUIRE(whole_ledger.failed() > 8);
  // A distance, and the look at a failure, in which the interruption is heard.
  for (int const last : {1, 2500, 9000}) {
    for (bool const looking : {false, true}) {
      CAPTURE(last);
      CAPTURE(looking);
      nlohmann::json stored;
      SilentProgress silent;
      Ledger ledger;
      RunContext first{5, silent, ledger, {}, [&](nlohmann::json const& state) { stored = state; }, 1e9, {}, {}, {}};
      CHECK(
          abc::run(LeftToy(models, looking ? infinity : last, looking ? 1 + last / 2500 : infinity), settings, first).interrupted);
      SilentProgress quiet;
      Ledger rest;
      RunContext second{5, quiet, rest, {}, {}, 60, kept(stored), {}, {}};
      check_same(whole, whole_ledger, abc::run(Toy(models), settings, second), rest);
    }
  }
}

TEST_CASE("a run interrupted between populations keeps the last one") {
  Toy const toy({{"narrow", 0.5, {{Prior::uniform, -1, 1}}, fails_at_the_edge},
                 {"wide", 0.5, {{Prior::uniform, -10, 10}}, fails_at_the_edge}});
  Settings const settings = with({{"particles", std::int64_t{300}}, {"schedule", std::vector<double>{0.8, 0.3, 0.1}}});
  Ledger ledger;
  SelectionResult const whole = run(toy, settings, 5, &ledger);
  REQUIRE(ledger.failures().size() > 2);
  Broken const broken = break_when(toy, settings, [](Phase const& phase) { return phase.population == 3; });
  CHECK(broken.part.interrupted);
  CHECK(broken.part.populations.size() == 2);
  CHECK(broken.checkpoint.at("record").at("counts").at(3) == 0);
  check_same(broken.resumed, broken.ledger, whole, ledger);
}

TEST_CASE("a model that has died and then an interruption: its last particles and the reason come back") {
  Toy const toy({{"near", 0.5, {{Prior::uniform, -1, 1}}, size_of_first},
                 {"far", 0.5, {{Prior::uniform, -1, 1}}, [](std::span<double const> p) { return 0.5 + std::fabs(p[0]); }}});
  Settings const settings = with({{"particles", std::int64_t{300}}, {"schedule", std::vector<double>{1, 0.4, 0.1}}});
  Ledger ledger;
  SelectionResult const whole = run(toy, settings, 5, &ledger);
  REQUIRE(whole.models[1].died_in == 2);
  REQUIRE(whole.models[1].weight.size() > 10);
  Broken const broken = break_when(toy, settings, [](Phase const& phase) { return phase.population == 3; });
  CHECK(broken.part.models[1].died_in == 2);
  CHECK(broken.resumed.models[1].died_in == 2);
  CHECK(broken.resumed.models[1].by_chance == whole.models[1].by_chance);
  check_same(broken.resumed, broken.ledger, whole, ledger);
}

TEST_CASE("systematic resampling gives each item its share, rounded up or down") {
  std::vector<double> const weights = {0.1, 0.25, 0.0, 0.65};
  std::vector<int> const chosen = resample(weights, 1000, 0.37);
  REQUIRE(chosen.size() == 1000);
  for (int item = 0; item < 4; ++item) {
    auto const count = std::count(chosen.begin(), chosen.end(), item);
    CHECK(std::fabs(static_cast<double>(count) - 1000 * weights[static_cast<std::size_t>(item)]) < 1);
  }
}

TEST_CASE("weighted summaries of a small set by hand") {
  std::vector<double> const values = {3, 1, 2}, weights = {0.2, 0.5, 0.3};
  WeightedSummary const summary = summarise_weighted("p", "m", values, weights);
  CHECK(summary.mean == doctest::Approx(1.7));
  CHECK(summary.sd == doctest::Approx(std::sqrt(0.2 * 1.69 + 0.5 * 0.49 + 0.3 * 0.09)));
  CHECK(summary.median == 1);
  CHECK(summary.q95 == 3);
}
