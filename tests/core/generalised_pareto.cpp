// Against R's package loo 2.5.1: fits by `gpdfit(x)`, weights by `psis(log_ratios, r_eff = r)`, of numbers that a formula gives.
#include "core/numeric/generalised_pareto.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "relative.hpp"

using namespace sysid;

namespace {

using Values = std::vector<double>;

/// `qgpd((1:n - 0.5) / n, k, sigma)`
Values exact_tail(int n, double k, double sigma) {
  Values out;
  for (int i = 1; i <= n; ++i) out.push_back(GeneralisedPareto{k, sigma}.quantile((i - 0.5) / n));
  return out;
}

/// `-size * log((1:n * 0.6180339887498949) %% 1)`
Values spread_ratios(int n, double size) {
  Values out;
  for (int i = 1; i <= n; ++i) out.push_back(-size * std::log(std::fmod(i * 0.6180339887498949, 1)));
  return out;
}

double sum(Values const& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

void check_fit(Values const& x, double k, double sigma) {
  GeneralisedPareto const fit = fit_generalised_pareto(x);
  CHECK(fit.k == relative(k, 1e-12));
  CHECK(fit.sigma == relative(sigma, 1e-12));
}

}  // namespace

TEST_CASE("fits of generalised Pareto distributions are those of R") {
  check_fit(exact_tail(50, 0.4, 2), 0.42833856659341291, 1.95374177106717717);
  check_fit(exact_tail(400, 1.3, 0.01), 1.274532630440362357, 0.010041200575494397);
  Values squares, bounded;
  for (int i = 1; i <= 30; ++i) squares.push_back(i * i / 100.0);
  for (int i = 20; i >= 1; --i) bounded.push_back(1 - std::pow(i / 21.0, 3));
  check_fit(squares, 0.030456997510706227, 3.527782713014619986);
  check_fit(bounded, -1.4134625223993593, 2.3822487011549143);
}

TEST_CASE("quantiles of generalised Pareto distributions are those of R") {
  CHECK(GeneralisedPareto{0.7, 3}.quantile(0.99) == doctest::Approx(103.366561350410478326).epsilon(1e-13));
  CHECK(GeneralisedPareto{-0.3, 3}.quantile(0.5) == doctest::Approx(1.877476036437645046).epsilon(1e-13));
  CHECK(GeneralisedPareto{0, 3}.quantile(0.5) == doctest::Approx(3 * std::log(2)).epsilon(1e-14));
  CHECK(GeneralisedPareto{1e-12, 3}.quantile(0.5) == doctest::Approx(3 * std::log(2)).epsilon(1e-10));
}

TEST_CASE("a tail without a quarter of exceedances has no fit") {
  CHECK(std::isinf(fit_generalised_pareto(Values{0, 0, 0, 1, 2}).k));
  CHECK(std::isinf(fit_generalised_pareto(Values{0, 0, 0, 0, 0}).k));
}

TEST_CASE("smoothed weights are those of R") {
  struct Case {
    double size, r_eff, k, sum_of_logs, first, sum_of_weights;
    int tail;
  };
  for (Case const& each :
       {Case{0.2, 1, 0.21200068809641270, 199.89238303950341, 9.6242365011920628e-02, 1249.3743986655084, 95},
        Case{0.8, 1, 0.72160070580434321, 797.12878079771780904, 0.38496946004768251, 3931.61880634140243274, 95},
        Case{0.5, 0.3, 0.46943314309195505, 498.81225661112489433, 0.24060591252980190, 1963.82667332724213338, 174}}) {
    CAPTURE(each.size);
    CHECK(pareto_tail_length(1000, each.r_eff) == each.tail);
    SmoothedWeights const smoothed = smooth_weights(spread_ratios(1000, each.size), each.tail);
    CHECK(smoothed.k == relative(each.k, 1e-11));
    CHECK(sum(smoothed.log_weights) == doctest::Approx(each.sum_of_logs).epsilon(1e-11));
    CHECK(smoothed.log_weights.front() == relative(each.first, 1e-13));
    Values weights;
    for (double const w : smoothed.log_weights) weights.push_back(std::exp(w));
    CHECK(sum(weights) == doctest::Approx(each.sum_of_weights).epsilon(1e-11));
  }
}

TEST_CASE("weights without a tail stay as they are") {
  Values const equal(100, -3), few = {1, 2, 3, 4, 5, 6};
  CHECK(smooth_weights(equal, 20).log_weights == equal);
  CHECK(smooth_weights(equal, 20).k == -std::numeric_limits<double>::infinity());  // harmless
  Values capped = spread_ratios(1000, 1.2);                                        // two fifths of them share the largest value
  for (double& each : capped) each = std::min(each, 1.0);
  CHECK(smooth_weights(capped, 95).k == -std::numeric_limits<double>::infinity());
  Values const nowhere(100, -std::numeric_limits<double>::infinity());
  CHECK(smooth_weights(nowhere, 20).k == std::numeric_limits<double>::infinity());
  CHECK(smooth_weights(few, 2).log_weights == few);
  CHECK(smooth_weights(few, 6).log_weights == few);
  CHECK(smooth_weights(few, 6).k == std::numeric_limits<double>::infinity());
}

TEST_CASE("smoothed weights keep their order and do not exceed the largest of before") {
  Values const ratios = spread_ratios(1000, 1.2);
  SmoothedWeights const smoothed = smooth_weights(ratios, 95);
  CHECK(smoothed.k > 1);
  CHECK(*std::ranges::max_element(smoothed.log_weights) <= *std::ranges::max_element(ratios));
  std::vector<int> order(ratios.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int i) { return ratios[static_cast<std::size_t>(i)]; });
  CHECK(std::ranges::is_sorted(order, {}, [&](int i) { return smoothed.log_weights[static_cast<std::size_t>(i)]; }));
}
