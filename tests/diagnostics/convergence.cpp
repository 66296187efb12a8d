// Convergence diagnostics against what the R package `posterior` said of recorded draws (fixtures/make_fixtures.R), and at their
// edges.
#include "diagnostics/convergence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "sanitized.hpp"

using namespace sysid;

namespace {

std::vector<std::vector<std::string>> read_fixture(std::string const& name) {
  std::ifstream file(std::string(SYSID_SOURCE_DIR) + "/tests/diagnostics/fixtures/" + name);
  REQUIRE(file.good());
  std::vector<std::vector<std::string>> rows;
  for (std::string line, cell; std::getline(file, line);) {
    rows.emplace_back();
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

std::map<std::string, ChainValues> recorded_draws() {
  std::map<std::string, ChainValues> sets;
  for (auto const& row : read_fixture("draws.csv")) {
    if (row[0].starts_with("#")) continue;
    auto& chain = sets[row[0]].emplace_back();
    for (std::size_t i = 2; i < row.size(); ++i) chain.push_back(std::stod(row[i]));
  }
  return sets;
}

bool agree(double ours, double theirs) {
  if (std::isnan(ours) || std::isnan(theirs)) return std::isnan(ours) && std::isnan(theirs);
  return std::fabs(ours - theirs) <= 1e-10 * std::fabs(theirs);
}

std::vector<double> normals(std::size_t count, std::uint64_t index, double mean = 0) {
  Stream stream({7, Purpose::test, index, 0});
  std::vector<double> x(count);
  for (double& v : x) v = mean + stream.normal();
  return x;
}

}  // namespace

TEST_CASE("diagnostics equal those of the R package posterior on recorded draws") {
  auto const sets = recorded_draws();
  auto const answers = read_fixture("posterior.csv");
  REQUIRE(answers.size() == sets.size() + 1);
  for (std::size_t row = 1; row < answers.size(); ++row) {
    auto const& cells = answers[row];
    REQUIRE(cells.size() == 12);
    CAPTURE(cells[0]);
    ChainValues const& draws = sets.at(cells[0]);
    std::vector<double> theirs;
    for (std::size_t i = 1; i < cells.size(); ++i) theirs.push_back(std::stod(cells[i]));
    Summary const s = summarise("a", "", draws);
    std::vector<double> const ours = {s.rhat, s.ess_bulk, s.ess_tail, ess_mean(draws), s.mcse_mean, s.mean, s.median, s.sd,
                                      s.mad,  s.q5,       s.q95};
    for (std::size_t i = 0; i < ours.size(); ++i) {
      CAPTURE(answers[0][i + 1]);
      CAPTURE(ours[i]);
      CAPTURE(theirs[i]);
      CHECK(agree(ours[i], theirs[i]));
    }
    CHECK(agree(rhat(draws), theirs[0]));
    CHECK(agree(ess_bulk(draws), theirs[1]));
    CHECK(agree(ess_tail(draws), theirs[2]));
    CHECK(agree(mcse_mean(draws), theirs[4]));
  }
}

TEST_CASE("chains in different places raise rhat, chains in one place do not") {
  ChainValues const same = {normals(1000, 0), normals(1000, 1), normals(1000, 2), normals(1000, 3)};
  ChainValues const apart = {normals(1000, 0), normals(1000, 1), normals(1000, 2), normals(1000, 3, 0.5)};
  CHECK(rhat(same) < 1.01);
  CHECK(rhat(apart) > 1.01);
}

TEST_CASE("constant, empty and non-finite draws have no diagnostics") {
  ChainValues infinite = {normals(100, 0), normals(100, 1)};
  infinite[1][3] = infinity;
  for (ChainValues const& draws : {ChainValues{}, ChainValues{{}}, ChainValues{{1, 1, 1, 1}, {1, 1, 1, 1}}, infinite}) {
    CHECK(std::isnan(rhat(draws)));
    CHECK(std::isnan(ess_bulk(draws)));
    CHECK(std::isnan(ess_tail(draws)));
    CHECK(std::isnan(ess_mean(draws)));
    CHECK(std::isnan(summarise("a", "", draws).rhat));
  }
}

TEST_CASE("effective sample sizes do not depend on how many lags they need") {
  // Of autoregressive chains the correlation is r^lag: with small r few lags are summed one by one, with r near 1 a transform has
  // all of them, and between the two it takes over on the way.
  for (double const r : {-0.5, 0.0, 0.5, 0.9, 0.95, 0.96, 0.97, 0.98}) {
    CAPTURE(r);
    ChainValues draws;
    for (std::uint64_t c = 0; c < 4; ++c) {
      std::vector<double> chain = normals(3001, c);
      for (std::size_t i = 1; i < chain.size(); ++i) chain[i] += r * chain[i - 1];
      draws.push_back(std::move(chain));
    }
    // By its definition, on the halves: Geyer's initial monotone sequence.
    ChainValues halves;
    for (auto const& chain : draws) halves.emplace_back(chain.begin(), chain.begin() + 1500);
    for (auto const& chain : draws) halves.emplace_back(chain.end() - 1500, chain.end());
    auto const covariance = [&](std::size_t lag) {
      double sum = 0;
      for (auto const& chain : halves)
        for (auto [i, centre] = std::pair(std::size_t{0}, mean(chain)); i + lag < chain.size(); ++i)
          sum += (chain[i] - centre) * (chain[i + lag] - centre);
      return sum / (1500.0 * 8);
    };
    std::vector<double> means;
    for (auto const& chain : halves) means.push_back(mean(chain));
    double const within = covariance(0) * 1500 / 1499, total = covariance(0) + sample_variance(means);
    double pairs = 0, before = infinity, expected = 0;
    for (std::size_t lag = 0; lag < 1490; lag += 2) {
      auto const rho = [&](std::size_t at) { return at == 0 ? 1 : 1 - (within - covariance(at)) / total; };
      double const pair = rho(lag) + rho(lag + 1);
      if (pair <= 0) {
        double const even = rho(lag);
        double const tau = -1 + 2 * pairs + (even > 0 ? even : 0);
        expected = 12000 / tau;
        break;
      }
      before = std::min(before, pair);
      pairs += before;
    }
    CHECK(ess_mean(draws) == doctest::Approx(expected).epsilon(1e-9));
  }
}

TEST_CASE("draws of very small quantities have diagnostics too") {
  ChainValues draws = {normals(500, 0), normals(500, 1)};
  double const plain = ess_bulk(draws);
  for (auto& chain : draws)
    for (double& v : chain) v *= 1e-30;
  CHECK(ess_bulk(draws) == doctest::Approx(plain).epsilon(1e-12));
}

TEST_CASE("quantiles interpolate as R's type 7") {
  CHECK(quantile({4, 1, 3, 2}, 0.5) == 2.5);
  CHECK(quantile({4, 1, 3, 2}, 0) == 1);
  CHECK(quantile({4, 1, 3, 2}, 1) == 4);
  CHECK(quantile({4, 1, 3, 2}, 0.1) == doctest::Approx(1.3).epsilon(1e-15));
  CHECK(std::isnan(quantile({}, 0.5)));
}

TEST_CASE("ten quantities of four chains of 25,000 draws are summarised within seconds") {
  ChainValues draws;
  for (std::uint64_t c = 0; c < 4; ++c) {
    draws.push_back(normals(25000, c));
    for (std::size_t i = 1; i < draws[c].size(); ++i) draws[c][i] = 0.9 * draws[c][i - 1] + std::sqrt(1 - 0.81) * draws[c][i];
  }
  auto const begin = std::chrono::steady_clock::now();
  Summary const summary = summarise("a", "", draws);
  std::chrono::duration<double> const taken = std::chrono::steady_clock::now() - begin;
  MESSAGE("one quantity: " << taken.count() << " s");
  CHECK(taken.count() < 2 * testing::slower);  // some 0.1 s in release code; a quadratic autocovariance would take minutes
  // An AR(1) with coefficient 0.9 has n (1 - 0.9)/(1 + 0.9) effective draws for the mean; its estimate scatters by a few per cent.
  CHECK(summary.ess_bulk == doctest::Approx(1e5 / 19).epsilon(0.15));
}
