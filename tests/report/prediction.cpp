// Bands over draws and scores against data, by hand-made numbers.
#include "report/prediction.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

TEST_CASE("a band is pointwise: mean, sd and quantiles of type 7") {
  std::vector<std::vector<double>> trajectories;
  for (int d = 0; d <= 40; ++d) trajectories.push_back({static_cast<double>(d), 5.0});
  Band const b = band(trajectories);
  // 0 ... 40: type 7 puts the quantile p at 40 p; the variance of 0 ... n-1 is n(n+1)/12.
  CHECK(b.mean[0] == 20);
  CHECK(b.sd[0] == doctest::Approx(std::sqrt(41 * 42 / 12.0)).epsilon(1e-14));
  CHECK(b.lower[0] == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(b.upper[0] == doctest::Approx(39.0).epsilon(1e-14));
  CHECK(b.sd[1] == 0);
  CHECK(b.lower[1] == 5);
}

TEST_CASE("a draw that failed is left out whole; without draws there is no band") {
  Band const b = band({{1, 1}, {3, std::nan("")}, {2, 2}});
  CHECK(b.mean[0] == 1.5);
  CHECK(b.mean[1] == 1.5);
  CHECK(b.draws == 3);
  CHECK(b.left_out == 1);
  CHECK(band({{std::nan("")}}).left_out == 1);
  CHECK(band({{std::nan("")}}).mean.empty());
  Band const gap = band({{1, std::nan(""), 5}, {3, std::nan(""), 7}});  // a sample that follows from one that was not measured
  CHECK(gap.mean.front() == 2);
  CHECK(std::isnan(gap.mean[1]));
  CHECK(gap.mean[2] == 6);
  CHECK(gap.left_out == 0);
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
  CHECK(found[0].name == "nmse");
  CHECK(found[0].value == doctest::Approx(100 * 11.0 / 8).epsilon(1e-14));
  CHECK(found[1].name == "rmse");
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
