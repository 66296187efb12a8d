// Each chain check fires on its planted fault and is silent on sound chains.
#include "diagnostics/chain_checks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/numeric/random.hpp"
#include "diagnostics/convergence.hpp"

using namespace sysid;

namespace {

ChainValues chains(int count, std::size_t length, double rho = 0, double shift_last = 0) {
  ChainValues draws;
  for (int c = 0; c < count; ++c) {
    Stream stream({13, Purpose::test, static_cast<std::uint64_t>(c), 0});
    std::vector<double> x(length);
    for (std::size_t i = 0; i < length; ++i) x[i] = (i > 0 ? rho * x[i - 1] : 0) + std::sqrt(1 - rho * rho) * stream.normal();
    if (c == count - 1)
      for (double& v : x) v += shift_last;
    draws.push_back(std::move(x));
  }
  return draws;
}

ChainReport report(ChainValues const& draws) {
  return {
      {summarise("k", "N/m", draws)}, std::vector<double>(draws.size(), 0.3), std::vector<std::uint64_t>(draws.size(), 5000), true};
}

}  // namespace

TEST_CASE("sound chains raise nothing") { CHECK(check_chains(report(chains(4, 2000))).empty()); }

TEST_CASE("a chain that accepts almost nothing did not move, and that is all that is said") {
  ChainReport fixed = report(chains(4, 2000, 0, 50));
  fixed.acceptance_rate = {0.3, 0.3, 0.3, 1e-4};
  fixed.adaptive = false;
  Findings const findings = check_chains(fixed);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].code == FindingCode::chain_did_not_move);
  CHECK(findings[0].severity == Severity::error);
  CHECK(findings[0].message.find("chain 4 did not move: 0.01 % of the proposed moves were accepted") != std::string::npos);
  CHECK(findings[0].help.find("proposal = adaptive") != std::string::npos);
  fixed.adaptive = true;
  CHECK(check_chains(fixed)[0].help.find("burn_in") != std::string::npos);
}

TEST_CASE("a chain with few distinct states is named with their number") {
  ChainReport poor = report(chains(4, 2000));
  poor.distinct_states[1] = 37;
  Findings const findings = check_chains(poor);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].code == FindingCode::few_distinct_states);
  CHECK(findings[0].message.find("chain 2 visited only 37") != std::string::npos);
}

TEST_CASE("chains that disagree a little fail quietly, a lot loudly") {
  Findings const little = check_chains(report(chains(4, 5000, 0, 0.4)));
  REQUIRE_FALSE(little.empty());  // the variance of the half-chains' means is 0.034, so R-hat is near 1.017
  CHECK(little[0].code == FindingCode::chains_not_quite_agreed);
  Findings const much = check_chains(report(chains(4, 2000, 0, 3)));
  REQUIRE(much.size() == 1);
  CHECK(much[0].code == FindingCode::chains_disagree);
  CHECK(much[0].message.find("k (") != std::string::npos);
}

TEST_CASE("chains that lie apart are placed, and replica exchange is advised where it is not in use") {
  auto const with_draws = [](ChainValues const& values, Draws& draws) {
    ChainReport out = report(values);
    draws.names = {"k"};
    draws.parameter_count = 1;
    for (std::vector<double> const& chain : values) {
      draws.chains.emplace_back();
      for (double const each : chain) draws.chains.back().values.push_back({each});
    }
    out.draws = &draws;
    return out;
  };
  Draws apart, drifting;
  ChainReport modes = with_draws(chains(4, 2000, 0, 20), apart);
  Findings const two = check_chains(modes);
  REQUIRE(two.size() == 1);
  CHECK(two[0].message.find("in chains 1, 2, 3, between ") != std::string::npos);
  CHECK(two[0].message.ends_with("in chain 4"));
  CHECK(two[0].help.find("sample with tempering") != std::string::npos);
  CHECK(two[0].help.find("several modes") != std::string::npos);
  modes.exchanges = true;
  CHECK(check_chains(modes)[0].help.find("tempering") == std::string::npos);
  // On a ridge chains overlap: nothing is said to lie apart.
  ChainReport const ridge = with_draws(chains(4, 2000, 0.999), drifting);
  Findings const slow = check_chains(ridge);
  REQUIRE_FALSE(slow.empty());
  REQUIRE(slow[0].code == FindingCode::chains_disagree);
  CHECK(slow[0].message.find("lies between") == std::string::npos);
  CHECK(slow[0].help.find("ridges") != std::string::npos);
  CHECK(slow[0].help.find("tempering") != std::string::npos);
}

TEST_CASE("only what is far above the limit is said to be far above it") {
  ChainReport mixed = report(chains(4, 2000, 0, 3));
  Summary near = mixed.summaries[0];
  near.name = "c";
  near.rhat = 1.011;
  mixed.summaries.push_back(near);
  Findings const findings = check_chains(mixed);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].names == std::vector<std::string>{"k", "c"});
  CHECK(findings[0].message.find("R-hat of c (1.011) is also above it") != std::string::npos);
  CHECK(findings[0].message.find("c (1.011)") > findings[0].message.find("far above"));
  mixed.summaries.pop_back();
  CHECK(check_chains(mixed)[0].message.find("above it") == std::string::npos);
}

TEST_CASE("too few independent draws are reported with how much longer to run") {
  // AR(1) with 0.98: 4 x 6000 (1 - 0.98)/(1 + 0.98) = 242 effective draws for the mean.
  Findings const findings = check_chains(report(chains(4, 6000, 0.98)));
  bool low = false;
  for (Finding const& f : findings)
    low = low || (f.code == FindingCode::ess_bulk_low && f.help.find("times as long") != std::string::npos);
  CHECK(low);
}

TEST_CASE("a parameter whose draws are all equal is named beside one that has too few") {
  ChainReport both = report(chains(4, 6000, 0.98));
  both.summaries.push_back(summarise("stuck", "", ChainValues(4, std::vector<double>(6000, 1.0))));
  bool named = false;
  for (Finding const& f : check_chains(both))
    named = named || (f.code == FindingCode::no_diagnostics && f.names == std::vector<std::string>{"stuck"});
  CHECK(named);
}

TEST_CASE("draws that are all equal cannot be judged, which is a failure too") {
  Findings const findings = check_chains(report(ChainValues(4, std::vector<double>(2000, 1.0))));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].code == FindingCode::no_diagnostics);
}
