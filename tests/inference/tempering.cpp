// Replica exchange against posteriors known in closed form that one chain does not sample: several modes, ridges, funnels.
#include "inference/chain/tempering.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnostics/verdict.hpp"
#include "inference/chain/difference_moves.hpp"
#include "inference/chain/ladder.hpp"
#include "inference/interruptions.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

Settings tempered(std::int64_t samples, std::int64_t burn_in, std::int64_t temperatures = 16, std::string const& start = "global") {
  Settings settings(tempering::settings());
  settings.set("samples", samples);
  settings.set("burn_in", burn_in);
  settings.set("thin", std::int64_t{2});
  settings.set("temperatures", temperatures);
  settings.set("start", start);
  return settings;
}

FitResult temper(Target const& target, Settings const& settings, std::uint64_t seed = 1) {
  Bench bench(seed);
  return tempering::run(target, settings, bench.context);
}

bool has(FitResult const& result, FindingCode code) {
  return std::any_of(result.findings.begin(), result.findings.end(), [&](Finding const& each) { return each.code == code; });
}

/// Mean and sd of every parameter within four Monte Carlo standard errors, by the effective sizes that the run states.
void check_summary(FitResult const& result, std::size_t p, double mean, double sd) {
  Summary const s = summarise(result)[p];
  CAPTURE(s.name);
  CHECK(s.rhat < 1.01);
  CHECK(s.ess_bulk >= 400);
  CHECK(std::fabs(s.mean - mean) < 4 * s.mcse_mean);
  CHECK(s.sd == doctest::Approx(sd).epsilon(0.1));
}

/// Four modes of the shares 0.4, 0.3, 0.2, 0.1 on the corners of a square, a hundred sds apart.
TestTarget four_modes() {
  return TestTarget({"x", "y"}, {{Prior::uniform, -10, 10}, {Prior::uniform, -10, 10}}, 1, 7000,
                    [](std::vector<double> const& w, std::vector<double>& rows) {
                      double const shares[] = {0.4, 0.3, 0.2, 0.1}, xs[] = {-5, 5, -5, 5}, ys[] = {-5, -5, 5, 5};
                      double parts[4];
                      for (int k = 0; k < 4; ++k)
                        parts[k] = std::log(shares[k]) - 50 * (std::pow(w[0] - xs[k], 2) + std::pow(w[1] - ys[k], 2));
                      double const high = *std::max_element(parts, parts + 4);
                      double sum = 0;
                      for (double const part : parts) sum += std::exp(part - high);
                      rows[0] = as_residual(high + std::log(sum), 7000);
                    });
}

}  // namespace

TEST_CASE("separate modes get their shares from draws of the prior alone") {
  FitResult const result = temper(four_modes(), tempered(12000, 4000, 16, "prior"));
  CHECK_FALSE(has(result, FindingCode::replicas_do_not_mix));
  check_summary(result, 0, -1, std::sqrt(24.01));  // 0.6 at -5, 0.4 at 5
  check_summary(result, 1, -2, std::sqrt(21.01));  // 0.7 at -5, 0.3 at 5
  CHECK(verdict_of(result.findings).pass);
}

TEST_CASE("a ridge of which only the product is known is sampled to its ends") {
  // a b = 1 to a thousandth, a and b log-uniform over [0.01, 100]: log a is uniform where 1/a is within the prior of b, so over
  // all.
  TestTarget const target({"a", "b"}, {{Prior::log_uniform, 0.01, 100}, {Prior::log_uniform, 0.01, 100}}, 1, 0,
                          [](std::vector<double> const& w, std::vector<double>& rows) {
                            rows[0] = (elementary::log(w[0]) + elementary::log(w[1])) / 1e-3;
                          });
  FitResult const result = temper(target, tempered(16000, 4000, 24));
  std::vector<double> logs;
  for (Chain const& chain : result.draws.chains)
    for (auto const& draw : chain.values) logs.push_back(std::log(draw[0]) / std::log(100.0));
  Summary const a = summarise(result)[0];
  CHECK(a.rhat < 1.01);
  CHECK(a.ess_bulk > 400);
  double mean = 0, square = 0;
  for (double const x : logs) mean += x / static_cast<double>(logs.size());
  for (double const x : logs) square += x * x / static_cast<double>(logs.size());
  CHECK(std::fabs(mean) < 4 * std::sqrt(1.0 / 3) / std::sqrt(a.ess_bulk));
  CHECK(square == doctest::Approx(1.0 / 3).epsilon(0.1));  // uniform on [-1, 1]
}

TEST_CASE("a funnel is sampled into its neck") {
  // Neal 2003: v ~ N(0, 3^2), x_i | v ~ N(0, exp(v)): in the likelihood's place the ratio to a wide normal prior.
  constexpr double wide = 40;
  std::vector<Prior> priors{{Prior::normal, 0, 3}};
  std::vector<std::string> names{"v"};
  for (int i = 0; i < 4; ++i) {
    priors.push_back({Prior::normal, 0, wide});
    names.push_back("x" + std::to_string(i));
  }
  TestTarget const target(names, priors, 1, 200, [](std::vector<double> const& w, std::vector<double>& rows) {
    double log_density = 0;
    for (std::size_t i = 1; i < w.size(); ++i)
      log_density += -w[0] / 2 - w[i] * w[i] / 2 * (std::exp(-w[0]) - 1 / (wide * wide)) + std::log(wide);
    rows[0] = as_residual(std::min(log_density, 199.0), 200);
  });
  FitResult const result = temper(target, tempered(30000, 8000, 24));
  check_summary(result, 0, 0, 3);
}

TEST_CASE("powers move to where neighbours are exchanged equally often") {
  // Log likelihoods -x^2/2 N: of x ~ N(0, 1/(1 + b N)) at power b, for many samples N.
  constexpr double samples = 1e6;
  tempering::Ladder ladder(12);
  std::uint64_t step = 0;
  for (int round = 0; round < 8; ++round) {
    ladder.forget_counts();
    for (int i = 0; i < 2000; ++i) {
      double values[12];
      for (int k = 0; k < 12; ++k) {
        Stream stream({2, Purpose::test, static_cast<std::uint64_t>(k), ++step});
        double const z = stream.normal();
        values[k] = -0.5 * samples * z * z / (1 + ladder.power(k) * samples);
      }
      for (int k = 0; k < 11; ++k) ladder.count(k, ladder.probability(k, values[k], values[k + 1]));
    }
    if (round < 7) ladder.equalise();
  }
  double const even = 1 - ladder.barrier() / 11;
  CHECK(ladder.least_acceptance() > even - 0.05);
  CHECK(ladder.power(0) == 1);
  CHECK(ladder.power(11) == 0);
  for (int k = 0; k < 11; ++k) CHECK(ladder.power(k) > ladder.power(k + 1));
}

TEST_CASE("too few temperatures are named with a number that is enough") {
  FitResult const poor = temper(four_modes(), tempered(3000, 1000, 3));
  REQUIRE(has(poor, FindingCode::replicas_do_not_mix));
  FitResult const rich = temper(four_modes(), tempered(3000, 1000, 16));
  CHECK_FALSE(has(rich, FindingCode::replicas_do_not_mix));
}

TEST_CASE("differences of an archive lead along it, and from one of its parts to another") {
  LaneArray archive(1, 4), from(1, 1), to(1, 1);
  archive(0, 0) = 0, archive(0, 1) = 0.1, archive(0, 2) = 10, archive(0, 3) = 10.1;
  metropolis::DifferenceMoves const moves(archive);
  int far = 0, whole = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    bool const is_whole = moves.propose({1, Purpose::test, i, 0}, from, 0, to, 0);
    whole += is_whole;
    far += is_whole && std::fabs(std::fabs(to(0, 0)) - 10) < 0.5;
  }
  CHECK(whole == doctest::Approx(400).epsilon(0.15));
  CHECK(far == doctest::Approx(whole * 2 / 3.0).epsilon(0.15));  // two of three partners lie in the other part
}

TEST_CASE("a tempered run stopped anywhere and resumed gives the bytes of one that never stopped") {
  TestTarget const target = four_modes();
  for (char const* start : {"global", "prior"}) {
    CAPTURE(start);
    Settings const settings = tempered(400, 200, 5, start);
    Unbroken const whole = unbroken(tempering::run, target, settings);
    int const end = whole.questions;
    check_stops(tempering::run, target, settings, whole, {3, end - 350, end - 230, end - 200, end - 57, end - 1});
  }
}

TEST_CASE("a tempered run whose move is given up goes on from before it, to the same bytes") {
  check_given_up(tempering::run, four_modes(), tempered(400, 200, 5, "prior"), {390, 150, 0});
}
