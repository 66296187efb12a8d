// Two samples of one distribution agree; samples of two do not, and the message names the number that differs most.
#include "diagnostics/calibration/agreement.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

ChainValues normal_chains(double mean, double sd, std::uint64_t number) {
  ChainValues chains(4);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    Stream stream({41, Purpose::test, number, c});
    for (int i = 0; i < 1000; ++i) chains[c].push_back(mean + sd * stream.normal());
  }
  return chains;
}

Findings findings_of(ChainValues const& one, ChainValues const& other) {
  return agreement_findings(compare_draws("k", "N/m", one, other), "mh", "nuts", false);
}

}  // namespace

TEST_CASE("errors of summaries are those of independent normal draws") {
  auto const numbers = compare_draws("k", "N/m", normal_chains(5, 2, 1), normal_chains(5, 2, 2));
  REQUIRE(numbers.size() == 5);
  double const n = 4000, twice = std::sqrt(2.0);
  CHECK(numbers[0].error == relative(twice * 2 / std::sqrt(n), 0.1));
  CHECK(numbers[1].error == relative(twice * 2 / std::sqrt(2 * n), 0.15));
  // sqrt(p (1 - p) / n) over the density at the quantile.
  CHECK(numbers[3].error == relative(twice * 2 * std::sqrt(0.25 / n) / 0.39894, 0.25));
  CHECK(numbers[4].error == relative(twice * 2 * std::sqrt(0.0475 / n) / 0.10314, 0.35));
  CHECK(numbers[4].first == doctest::Approx(5 + 2 * 1.645).epsilon(0.02));
}

TEST_CASE("samples of one distribution agree, and z scores are of size 1") {
  double squares = 0;
  int warned = 0;  // one time in a hundred, and of 40 more than four times in one of 10^5
  for (std::uint64_t r = 0; r < 40; ++r) {
    ChainValues const one = normal_chains(0, 1, 100 + r), other = normal_chains(0, 1, 300 + r);
    warned += findings_of(one, other).empty() ? 0 : 1;
    for (ComparedNumber const& each : compare_draws("k", "", one, other)) squares += each.z() * each.z() / 200;
  }
  CHECK(warned <= 4);
  CHECK(squares > 0.7);
  CHECK(squares < 1.4);
}

TEST_CASE("samples of two distributions differ") {
  ChainValues const one = normal_chains(0, 1, 1);
  Findings const shifted = findings_of(one, normal_chains(0.2, 1, 2)), wider = findings_of(one, normal_chains(0, 1.15, 3));
  for (Findings const* each : {&shifted, &wider}) {
    REQUIRE(each->size() == 1);
    CHECK(each->front().code == FindingCode::backends_disagree);
    CHECK(each->front().severity == Severity::error);
    CHECK(each->front().names == std::vector<std::string>{"k"});
  }
  CHECK(shifted.front().message.find("mean") != std::string::npos);
  CHECK(wider.front().message.find("sd") != std::string::npos);
}

TEST_CASE("what is not finite or has no error never agrees, unless both are the same") {
  double const nan = std::nan("");
  auto const code = [](ComparedNumber const& each, bool with_optimum) {
    return agreement_findings({each}, "mh", "nuts", with_optimum).size();
  };
  for (bool const with_optimum : {false, true}) {
    CHECK(code({"k", "", "mean", nan, 1, 0.1}, with_optimum) == 1);
    CHECK(code({"k", "", "mean", 1, 1.1, nan}, with_optimum) == 1);
    CHECK(code({"k", "", "mean", 1, 1.1, 0}, with_optimum) == 1);
    CHECK(code({"k", "", "mean", nan, nan, nan}, with_optimum) == 1);
    CHECK(code({"k", "", "mean", 1, 1, 0}, with_optimum) == 0);
    CHECK(code({"k", "", "mean", 1, 1, nan}, with_optimum) == 0);
  }
  ChainValues const still(4, std::vector<double>(100, 2.0)), other(4, std::vector<double>(100, 3.0));
  CHECK(findings_of(still, still).empty());
  CHECK(findings_of(still, other).size() == 1);
  CHECK(findings_of(normal_chains(0, 1, 1), ChainValues(4, std::vector<double>(1000, nan))).size() == 1);
}

TEST_CASE("correlated draws of one distribution agree") {
  auto const autoregression = [](std::uint64_t number) {
    ChainValues chains(4);
    for (std::size_t c = 0; c < chains.size(); ++c) {
      Stream stream({42, Purpose::test, number, c});
      double x = stream.normal();
      for (int i = 0; i < 2000; ++i) chains[c].push_back(x = 0.9 * x + std::sqrt(1 - 0.81) * stream.normal());
    }
    return chains;
  };
  int doubted = 0;  // one time in a hundred
  for (std::uint64_t r = 0; r < 40; ++r) doubted += findings_of(autoregression(r), autoregression(100 + r)).empty() ? 0 : 1;
  CHECK(doubted <= 5);
}

TEST_CASE("an optimum differs from a posterior by parts of its sd") {
  ChainValues const draws = normal_chains(1, 0.5, 1);
  auto const findings = [&](double optimum, double sd) {
    return agreement_findings(compare_optimum("k", "", draws, optimum, sd), "map", "mh", true);
  };
  CHECK(findings(1.05, 0.53).empty());
  REQUIRE(findings(1.2, 0.5).size() == 1);
  CHECK(findings(1.2, 0.5).front().severity == Severity::warning);
  CHECK(findings(1, 0.2).size() == 1);
}
