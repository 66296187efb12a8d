// Weights of models with known answers, and what any weights keep to.
#include "criteria/model_weights.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

/// Of two models: so many samples twice as likely under the first, so many under the second.
PointwiseElpd counted(int first, int second) {
  PointwiseElpd out(2);
  for (int i = 0; i < first + second; ++i) {
    out[0].push_back(i < first ? std::log(2) : 0);
    out[1].push_back(i < first ? 0 : std::log(2));
  }
  return out;
}

double sum(std::vector<double> const& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

TEST_CASE("stacking weights have their closed form for samples of two kinds") {
  // a log(1 + w) + b log(2 - w) is largest at w = (2 a - b) / (a + b).
  CHECK(stacking_weights(counted(3, 2))[0] == doctest::Approx(0.8).epsilon(1e-4));
  CHECK(stacking_weights(counted(5, 5))[0] == doctest::Approx(0.5).epsilon(1e-9));
  CHECK(stacking_weights(counted(1, 9))[0] < 1e-4);  // at the bound
  CHECK(stacking_weights(counted(9, 1))[1] < 1e-4);
}

TEST_CASE("stacking gives models that say the same the weight of one, pseudo-BMA gives it to each") {
  PointwiseElpd two = counted(6, 4), three = two;
  three.push_back(two[0]);
  std::vector<double> const of_two = stacking_weights(two), of_three = stacking_weights(three);
  CHECK(of_three[0] + of_three[2] == doctest::Approx(of_two[0]).epsilon(1e-3));
  std::vector<double> const bma = pseudo_bma_weights(three, 1);
  CHECK(bma[0] == doctest::Approx(bma[2]).epsilon(1e-12));
}

TEST_CASE("weights are shares, and a constant that all models share moves none") {
  PointwiseElpd elpd(3);
  Stream stream({9, Purpose::test, 0, 0});
  for (auto& model : elpd)
    for (int i = 0; i < 50; ++i) model.push_back(stream.normal() - 300);
  PointwiseElpd shifted = elpd;
  for (auto& model : shifted)
    for (double& each : model) each += 1000;
  for (auto const& weights : {stacking_weights(elpd), pseudo_bma_weights(elpd, 1)}) {
    CHECK(sum(weights) == doctest::Approx(1).epsilon(1e-12));
    for (double const each : weights) CHECK(each >= 0);
  }
  CHECK(stacking_weights(shifted)[0] == relative(stacking_weights(elpd)[0], 1e-6));
  CHECK(pseudo_bma_weights(shifted, 1)[0] == relative(pseudo_bma_weights(elpd, 1)[0], 1e-9));
  CHECK(pseudo_bma_weights(elpd, 1) == pseudo_bma_weights(elpd, 1));
}

TEST_CASE("no weights of two models score better than stacked ones") {
  PointwiseElpd elpd(2);
  Stream stream({10, Purpose::test, 0, 0});
  for (int i = 0; i < 200; ++i) {
    double const y = stream.normal();
    elpd[0].push_back(-0.5 * (y - 0.6) * (y - 0.6));
    elpd[1].push_back(-0.5 * (y + 0.8) * (y + 0.8));
  }
  auto const score = [&](double w) {
    double total = 0;
    for (std::size_t i = 0; i < elpd[0].size(); ++i) total += std::log(w * std::exp(elpd[0][i]) + (1 - w) * std::exp(elpd[1][i]));
    return total;
  };
  double const best = score(stacking_weights(elpd)[0]);
  for (double w = 0; w <= 1; w += 0.01) CHECK(score(w) <= best + 200 * 1e-7);
}

TEST_CASE("pseudo-BMA with the bootstrap goes to a half where the difference is lost in its error") {
  PointwiseElpd elpd(2);
  Stream stream({12, Purpose::test, 0, 0});
  for (int i = 0; i < 400; ++i) {
    elpd[0].push_back(2 * stream.normal());
    elpd[1].push_back(2 * stream.normal());
  }
  ElpdDifference const difference = elpd_difference(elpd[0], elpd[1]);
  double const weight = pseudo_bma_weights(elpd, 1)[0];
  // Normal sums of that mean and error: nearly the probability that they are positive.
  CHECK(weight == doctest::Approx(std::erfc(-difference.sum / difference.error / std::sqrt(2)) / 2).epsilon(0.05));
  CHECK(difference.error == doctest::Approx(std::sqrt(400 * 8.0)).epsilon(0.1));
}
