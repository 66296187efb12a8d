// Scores against R's package loo on recorded draws (fixtures/make_fixtures.R), closed forms, and what weights must keep to.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "criteria/leave_out.hpp"
#include "criteria/scores.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

using Table = std::vector<std::vector<double>>;

Table read_fixture(std::string const& name) {
  std::ifstream file(std::string(SYSID_SOURCE_DIR) + "/tests/criteria/fixtures/" + name);
  REQUIRE(file.good());
  Table rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    rows.emplace_back();
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

double normal_log_density(double y, double mean, double sd) {
  return -std::log(sd) - 0.5 * std::log(2 * std::numbers::pi) - 0.5 * (y - mean) * (y - mean) / (sd * sd);
}

/// [samples x draws] of the recorded ones.
LaneArray recorded() {
  Table const draws = read_fixture("draws.csv"), samples = read_fixture("loo.csv");
  LaneArray out(static_cast<int>(samples.size()), static_cast<int>(draws.size()));
  for (int i = 0; i < out.rows(); ++i)
    for (int s = 0; s < out.width(); ++s) {
      auto const& draw = draws[static_cast<std::size_t>(s)];
      out(i, s) = normal_log_density(samples[static_cast<std::size_t>(i)][0], draw[1], draw[2]);
    }
  return out;
}

/// The mean of a normal of known sd, under a flat prior, from n samples; draws of it that are independent.
struct NormalMean {
  static constexpr int n = 20, draws = 4000;
  static constexpr double sd = 1.5;
  std::vector<double> y;
  LaneArray log_density{n, draws};

  NormalMean() {
    Stream noise({3, Purpose::test, 0, 0}), posterior({3, Purpose::test, 1, 0});
    for (int i = 0; i < n; ++i) y.push_back(0.7 + sd * noise.normal());
    double const centre = mean(y);
    for (int s = 0; s < draws; ++s) {
      double const mu = centre + sd / std::sqrt(n) * posterior.normal();
      for (int i = 0; i < n; ++i) log_density(i, s) = normal_log_density(y[static_cast<std::size_t>(i)], mu, sd);
    }
  }
  /// log density of sample i given those of [first, last) but not itself.
  double given(int i, int first, int last) const {
    double sum = 0;
    int count = 0;
    for (int j = first; j < last; ++j)
      if (j != i) sum += y[static_cast<std::size_t>(j)], ++count;
    return normal_log_density(y[static_cast<std::size_t>(i)], sum / count, sd * std::sqrt(1 + 1.0 / count));
  }
};

}  // namespace

TEST_CASE("leave-one-out and WAIC are those of R's loo on recorded draws, sample by sample") {
  LaneArray const log_density = recorded();
  Table const expected = read_fixture("loo.csv");
  DrawInfluence influence(static_cast<std::size_t>(log_density.width()));
  std::vector<double> elpd_loo, elpd_waic;
  double p_loo = 0, p_waic = 0;
  for (int i = 0; i < log_density.rows(); ++i) {
    CAPTURE(i);
    auto const& row = expected[static_cast<std::size_t>(i)];
    LeftOut const left_out = leave_out(log_density.row(i), 4);
    SampleScore const score = score_sample(log_density.row(i), 4, influence);
    CHECK(left_out.relative_efficiency == relative(row[1], 1e-9));
    CHECK(score.elpd_loo == relative(row[2], 1e-9));
    CHECK(score.log_density - score.elpd_loo == relative(row[3], 1e-8));
    CHECK(score.pareto_k == relative(row[4], 1e-8));
    CHECK(score.elpd_waic() == relative(row[5], 1e-9));
    CHECK(score.p_waic == relative(row[6], 1e-9));
    elpd_loo.push_back(score.elpd_loo);
    elpd_waic.push_back(score.elpd_waic());
    p_loo += score.log_density - score.elpd_loo;
    p_waic += score.p_waic;
  }
  LogScore const loo = sum_of(elpd_loo), waic = sum_of(elpd_waic);
  CHECK(loo.sum == relative(-32.3966267091766937, 1e-9));
  CHECK(loo.error == relative(8.0035924202993982, 1e-9));
  CHECK(p_loo == relative(5.9306469310101875, 1e-8));
  CHECK(waic.sum == relative(-31.5710776505549298, 1e-9));
  CHECK(waic.error == relative(7.3632193418717335, 1e-9));
  CHECK(p_waic == relative(5.1050978723884279, 1e-9));
}

TEST_CASE("a block that is left out has the weights and densities of R's psis") {
  LaneArray const all = recorded();
  LaneArray block(5, all.width());
  for (int i = 0; i < 5; ++i) std::ranges::copy(all.row(10 + i), block.row(i).begin());
  DrawInfluence influence(static_cast<std::size_t>(all.width()));
  BlockScore const score = leave_block_out(block, 4, influence);
  CHECK(score.pareto_k == relative(1.39078787867428266, 1e-8));
  std::vector<double> const expected = {-0.85926581813466651, -2.34368699803221681, -1.17519030088007148, -0.84434704266982841,
                                        -8.74042877110184868};
  for (std::size_t i = 0; i < 5; ++i) CHECK(score.elpd[i] == relative(expected[i], 1e-9));
}

TEST_CASE("samples, blocks and futures left out of a normal mean have their closed forms") {
  NormalMean const model;
  std::size_t const draws = NormalMean::draws;
  DrawInfluence loo(draws), block_influence(draws), future_influence(draws);
  double sum = 0, expected = 0, waic = 0;
  for (int i = 0; i < NormalMean::n; ++i) {
    SampleScore const score = score_sample(model.log_density.row(i), 1, loo);
    double const exact = model.given(i, 0, NormalMean::n);
    CHECK(score.elpd_loo == relative(exact, 0.01));
    CHECK(score.pareto_k < 0.5);
    sum += score.elpd_loo;
    waic += score.elpd_waic();
    expected += exact;
  }
  CAPTURE(loo.error());
  CHECK(loo.error() < 0.05);
  CHECK(std::fabs(sum - expected) < 4 * loo.error());
  CHECK(std::fabs(waic - sum) < 0.1);
  // The last five of twenty, alone and as the future of the fifteen before them.
  LaneArray last(5, NormalMean::draws), before(5, NormalMean::draws);
  for (int i = 0; i < 5; ++i) {
    std::ranges::copy(model.log_density.row(15 + i), last.row(i).begin());
    std::ranges::copy(model.log_density.row(10 + i), before.row(i).begin());
  }
  FutureOut future(NormalMean::draws, 1);
  BlockScore const block = leave_block_out(last, 1, block_influence);
  future.leave(last);
  BlockScore const ahead = future.score(last, largest_k_of_many, future_influence);
  future.leave(before);
  BlockScore const earlier = future.score(before, largest_k_of_many, future_influence);
  CHECK(block.elpd == ahead.elpd);
  REQUIRE(earlier.elpd.size() == 5);
  double difference = 0;
  for (int i = 0; i < 5; ++i) {
    difference += ahead.elpd[static_cast<std::size_t>(i)] - model.given(15 + i, 0, 15);
    difference += earlier.elpd[static_cast<std::size_t>(i)] - model.given(10 + i, 0, 10);
  }
  CAPTURE(future_influence.error());
  CHECK(future_influence.error() < 0.2);
  CHECK(std::fabs(difference) < 4 * future_influence.error());
}

TEST_CASE("a future that the weights do not reach has no score and no influence") {
  NormalMean const model;
  LaneArray all(NormalMean::n, NormalMean::draws);
  for (int i = 0; i < NormalMean::n; ++i)
    for (int s = 0; s < NormalMean::draws; ++s) all(i, s) = 3 * model.log_density(i, s);  // as of sixty samples, without all
  DrawInfluence influence(NormalMean::draws);
  FutureOut future(NormalMean::draws, 1);
  future.leave(all);
  BlockScore const score = future.score(all, largest_k_of_many, influence);
  CHECK(score.pareto_k > largest_k_of_many);
  CHECK(score.elpd.empty());
  CHECK(influence.error() == 0);
}

TEST_CASE("effective numbers of draws are those of an autoregression") {
  constexpr double rho = 0.5;
  std::vector<double> values;
  for (std::uint64_t chain = 0; chain < 4; ++chain) {
    Stream stream({11, Purpose::test, chain, 0});
    double x = stream.normal();
    for (int i = 0; i < 2000; ++i) values.push_back(x = rho * x + std::sqrt(1 - rho * rho) * stream.normal());
  }
  CHECK(relative_efficiency(values, 4) == relative((1 - rho) / (1 + rho), 0.1));
  CHECK(relative_efficiency(std::vector<double>(40, 2), 4) == 1);
  CHECK(relative_efficiency(std::vector<double>{1, 2, 3, 4}, 1) == 1);
}

TEST_CASE("the Monte Carlo error of a sum covers what other draws of slow chains give") {
  // 100 posteriors of the same samples, each of four chains with the autocorrelation 0.5: their sums spread as each says.
  constexpr double rho = 0.5;
  constexpr int chains = 4, length = 250, draws = chains * length, samples = 20, posteriors = 100;
  std::vector<double> sums, errors, y;
  Stream noise({3, Purpose::test, 0, 0});
  for (int i = 0; i < samples; ++i) y.push_back(noise.normal());
  for (std::uint64_t r = 0; r < posteriors; ++r) {
    Stream posterior({5, Purpose::test, r, 0});
    LaneArray density(samples, draws);
    double place = 0;
    for (int s = 0; s < draws; ++s) {
      place = s % length == 0 ? posterior.normal() : rho * place + std::sqrt(1 - rho * rho) * posterior.normal();
      double const mu = mean(y) + place / std::sqrt(static_cast<double>(samples));
      for (int i = 0; i < samples; ++i) density(i, s) = normal_log_density(y[static_cast<std::size_t>(i)], mu, 1);
    }
    DrawInfluence influence(draws);
    sums.push_back(0);
    for (int i = 0; i < samples; ++i) sums.back() += score_sample(density.row(i), chains, influence).elpd_loo;
    errors.push_back(influence.error());
  }
  double const ratio = mean(errors) / std::sqrt(sample_variance(sums));  // the sd of an sd of 100 is 7 %
  CAPTURE(ratio);
  CHECK(ratio > 0.9);  // 0.78 if draws counted as independent ones
  // Samples pull the mean both ways, so their sum varies less slowly than each of them, by whose efficiency draws are counted.
  CHECK(ratio < 1.6);
}

TEST_CASE("sums leave out what has no score, and blocks share the rows") {
  LogScore const score = sum_of(std::vector<double>{1, std::nan(""), 3});
  CHECK(score.sum == 4);
  CHECK(score.samples == 2);
  CHECK(score.error == relative(2, 1e-15));  // sqrt(2 * 2)
  CHECK(block_ends(25, 10) == std::vector<int>{0, 2, 5, 7, 10, 12, 15, 17, 20, 22, 25});
  CHECK(block_ends(3, 10) == std::vector<int>{0, 1, 2, 3});
  CHECK(block_ends(0, 10) == std::vector<int>{0});
}
