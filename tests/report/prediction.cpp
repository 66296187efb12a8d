// Bands over draws and scores against data, by hand-made numbers.
#include "diagnostics/scores.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "relative.hpp"

using namespace sysid;

TEST_CASE("a band is pointwise: mean, sd and quantiles of type 6") {
  std::vector<std::vector<double>> trajectories;
  for (int d = 0; d <= 40; ++d) trajectories.push_back({static_cast<double>(d), 5.0});
  Band const b = band(trajectories);
  // 0 ... 40: type 6 puts the quantile p at 42 p - 1; the variance of 0 ... n-1 is n(n+1)/12.
  CHECK(b.mean[0] == 20);
  CHECK(b.sd[0] == doctest::Approx(std::sqrt(41 * 42 / 12.0)).epsilon(1e-14));
  CHECK(b.lower[0] == relative(0.05, 1e-13));
  CHECK(b.upper[0] == doctest::Approx(39.95).epsilon(1e-14));
  CHECK(b.sd[1] == 0);
  CHECK(b.lower[1] == 5);
}

TEST_CASE("a band of any number of draws is that of each sample alone") {
  for (std::size_t const draws : {1, 2, 3, 38, 39, 41, 200, 279, 280, 320, 400}) {
    CAPTURE(draws);
    Stream stream({.seed = 2, .purpose = Purpose::test, .index = draws, .step = 0});
    std::vector<std::vector<double>> trajectories(draws, std::vector<double>(19));
    for (auto& trajectory : trajectories)
      for (double& value : trajectory) value = std::round(40 * stream.normal());  // with ties
    Band const b = band(trajectories);
    REQUIRE(b.mean.size() == 19);
    for (std::size_t i = 0; i < b.mean.size(); ++i) {
      std::vector<double> sample;
      for (auto const& trajectory : trajectories) sample.push_back(trajectory[i]);
      CHECK(b.mean[i] == mean(sample));
      CHECK(b.sd[i] == (draws > 1 ? std::sqrt(sample_variance(sample)) : 0));
      CHECK(b.lower[i] == predictive_quantile(sample, 0.025));
      CHECK(b.upper[i] == predictive_quantile(sample, 0.975));
    }
  }
}

TEST_CASE("a 95 % band of few draws holds 95 % of the draws that come next") {
  // 4000 samples of a band of 100 draws each: the sd of the share is 0.5 %, and type 7 would hold 93.1 %.
  constexpr std::size_t samples = 4000;
  Stream stream({.seed = 1, .purpose = Purpose::test, .index = 0, .step = 0});
  std::vector<std::vector<double>> trajectories(100, std::vector<double>(samples));
  for (auto& trajectory : trajectories)
    for (double& value : trajectory) value = stream.normal();
  Band const b = band(trajectories);
  double inside = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    double const next = stream.normal();
    inside += next >= b.lower[i] && next <= b.upper[i] ? 1 : 0;
  }
  CHECK(inside / samples == doctest::Approx(0.95).epsilon(0.013));
}

TEST_CASE("a draw that failed is left out whole; without draws there is no band") {
  Band const b = band({{1, 1}, {3, std::nan("")}, {2, 2}});
  CHECK(b.mean[0] == 1.5);
  CHECK(b.mean[1] == 1.5);
  CHECK(b.draws == 3);
  CHECK(b.excluded == 1);
  CHECK(band({{std::nan("")}}).excluded == 1);
  CHECK(band({{std::nan("")}}).mean.empty());
  Band const gap = band({{1, std::nan(""), 5}, {3, std::nan(""), 7}});  // a sample that follows from one that was not measured
  CHECK(gap.mean.front() == 2);
  CHECK(std::isnan(gap.mean[1]));
  CHECK(gap.mean[2] == 6);
  CHECK(gap.excluded == 0);
  CHECK(band({}).mean.empty());
}

TEST_CASE("scores count scored samples that are there") {
  PredictedQuantity q;
  q.response.mean = {0, 0, 0, 0, 0};
  q.measured = {1, -1, std::nan(""), 3, 100};
  std::vector<std::uint8_t> const scored = {1, 1, 1, 1, 0};
  auto const found = scores(q, scored);
  REQUIRE(found.size() == 2);
  // y = 1, -1, 3: mean 1, population variance 8/3; mean square 11/3.
  CHECK(found[0].name.kind == ScoreKind::nmse);
  CHECK(found[0].value == doctest::Approx(100 * 11.0 / 8).epsilon(1e-14));
  CHECK(found[1].name.kind == ScoreKind::rmse);
  CHECK(found[1].value == doctest::Approx(std::sqrt(11.0 / 3)).epsilon(1e-14));
}

TEST_CASE("coverage counts samples inside the band with noise") {
  PredictedQuantity q;
  q.response.mean = {0, 0, 0, 0};
  q.noisy = {{0, 0, 0, 0}, {1, 1, 1, 1}, {-2, -2, -2, -2}, {2, 2, 2, 2}};
  q.measured = {0, 1.9, 2.5, 3.5};
  auto const found = scores(q, {1, 1, 1, 1});
  REQUIRE(found.size() == 4);
  CHECK(found[2].value == 0.5);
  CHECK(found[3].value == 0.75);
}

TEST_CASE("nothing measured, nothing scored") {
  PredictedQuantity q;
  q.response.mean = {0, 0};
  CHECK(scores(q, {1, 1}).empty());
  q.measured = {1, 2};
  CHECK(scores(q, {0, 0}).empty());
}
