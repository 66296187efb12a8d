// Noise that is a moving average: removed by its own coefficients, found from a long series, and by an independent formula.
#include "regression/column/moving_average.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/numeric/random.hpp"
#include "linear_algebra/decompositions.hpp"

using namespace sysid;
using namespace sysid::regression;

namespace {

/// Independent e, and what the coefficients make of them; each run begins from e = 0.
struct Series {
  Eigen::VectorXd e, v;
  std::vector<Run> runs;

  Series(std::uint64_t seed, std::vector<double> const& c, std::vector<Eigen::Index> const& lengths) {
    Stream stream({seed, Purpose::test, 0, 0});
    Eigen::Index rows = 0;
    for (Eigen::Index const length : lengths) runs.push_back({rows, length}), rows += length;
    e.resize(rows);
    for (Eigen::Index i = 0; i < rows; ++i) e(i) = stream.normal();
    v = e;
    for (Run const& run : runs)
      for (Eigen::Index i = run.first; i < run.first + run.count; ++i)
        for (std::size_t k = 0; k < c.size(); ++k)
          if (i - static_cast<Eigen::Index>(k) - 1 >= run.first) v(i) += c[k] * e(i - static_cast<Eigen::Index>(k) - 1);
  }
};

}  // namespace

TEST_CASE("what a moving average is made of is found again where the errors before a run are forgotten") {
  std::vector<double> const c = {0.5, -0.3, 0.1};
  Series const series(1, c, {400, 2, 250});
  MovingAverage::Errors const e = MovingAverage{c}.errors(series.v, series.runs);
  CHECK((e.in_runs - series.e).tail(60).cwiseAbs().maxCoeff() < 1e-6);
  CHECK(e.squares() <= series.e.squaredNorm());  // with errors of 0 before the runs they are those of the series
  CHECK((MovingAverage{}.errors(series.v, series.runs).in_runs - series.v).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("squares and determinant of whitened rows are those of the covariance of a moving average") {
  // sd 1: the covariance of v is banded, 1 + c_1^2 + c_2^2, c_1 + c_1 c_2, c_2.
  std::vector<double> const c = {0.7, 0.2};
  Series const series(4, c, {30, 9, 1});
  double squares = 0, determinant = 0;
  for (Run const& run : series.runs) {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(run.count, run.count);
    for (Eigen::Index i = 0; i < run.count; ++i)
      for (Eigen::Index k = 0; k < run.count; ++k) {
        double const lags[] = {1 + 0.49 + 0.04, 0.7 + 0.14, 0.2};
        if (std::abs(i - k) < 3) covariance(i, k) = lags[std::abs(i - k)];
      }
    Eigen::MatrixXd const lower = *cholesky(covariance);
    Eigen::VectorXd const v = series.v.segment(run.first, run.count);
    squares += v.dot(Eigen::VectorXd(solve_cholesky(lower, v)));
    determinant += 2 * lower.diagonal().array().log().sum();
  }
  MovingAverage const average{c};
  CHECK(average.errors(series.v, series.runs).squares() == doctest::Approx(squares).epsilon(1e-12));
  CHECK(average.turned(average.divided(series.v, series.runs), series.runs).squaredNorm() ==
        doctest::Approx(squares).epsilon(1e-12));
  CHECK(average.log_determinant(series.runs) == doctest::Approx(determinant).epsilon(1e-12));
}

TEST_CASE("rows that are freed do not know what came before a run") {
  MovingAverage const average{{0.7, 0.2}};
  Series const series(4, {0.7, 0.2}, {30, 9, 2});
  Eigen::VectorXd moved = series.v;
  for (Run const& run : series.runs) {
    moved(run.first) += 0.7 * 5 + 0.2 * 3;  // e_-1 = 5, e_-2 = 3
    moved(run.first + 1) += 0.2 * 5;
  }
  auto const freed = [&](Eigen::VectorXd const& v) { return average.freed(average.divided(v, series.runs), series.runs); };
  CHECK(freed(moved).rows() == 28 + 7);
  CHECK((freed(moved) - freed(series.v)).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("slopes are the derivatives of -e by the coefficients, with the errors before the runs held") {
  std::vector<double> const c = {0.5, 0.2};
  Series const series(2, {0.7, -0.1}, {30, 20});
  MovingAverage::Errors const e = MovingAverage{c}.errors(series.v, series.runs);
  Eigen::MatrixXd const slopes = MovingAverage{c}.slopes(e, series.runs);
  auto const by_hand = [&](std::vector<double> const& other) {
    Eigen::VectorXd out = series.v;
    for (std::size_t r = 0; r < series.runs.size(); ++r)
      for (Eigen::Index i = 0; i < series.runs[r].count; ++i)
        for (Eigen::Index k = 1; k <= 2; ++k) {
          Eigen::Index const first = series.runs[r].first;
          out(first + i) -= other[static_cast<std::size_t>(k - 1)] *
                            (i >= k ? out(first + i - k) : e.before(k - i - 1, static_cast<Eigen::Index>(r)));
        }
    return out;
  };
  CHECK((by_hand(c) - e.in_runs).cwiseAbs().maxCoeff() < 1e-12);
  double const step = 1e-6;
  for (std::size_t k = 0; k < c.size(); ++k) {
    std::vector<double> more = c, less = c;
    more[k] += step;
    less[k] -= step;
    Eigen::VectorXd const by_difference = (by_hand(less) - by_hand(more)) / (2 * step);
    CHECK((slopes.col(static_cast<Eigen::Index>(k)) - by_difference).cwiseAbs().maxCoeff() < 1e-7);
  }
}

TEST_CASE("the coefficients of a long series are found within what theory says of their errors") {
  // Of a first-order moving average the sd of the estimate is sqrt((1 - c^2)/n) (Box and Jenkins 1976, eq. 7.2.14).
  for (double const c : {-0.8, 0.3, 0.6}) {
    double sum = 0;
    int const series = 40, rows = 1000;
    for (int k = 0; k < series; ++k) {
      Series const made(100 + static_cast<std::uint64_t>(k), {c}, {rows});
      double const z = (fitted_moving_average(made.v, made.runs, {{0}}).coefficients[0] - c) / std::sqrt((1 - c * c) / rows);
      sum += z * z;
    }
    CAPTURE(c);
    CHECK(sum > 20);  // chi-squared of 40 degrees of freedom: once in 200 below, once in 500 above
    CHECK(sum < 73);
  }
}

TEST_CASE("an estimate stays invertible where the series is a difference, whose zero lies on the unit circle") {
  Series const difference(3, {-1}, {2000});
  MovingAverage const found = fitted_moving_average(difference.v, difference.runs, {{-1.5}});  // a start that is not invertible
  CHECK(found.coefficients[0] < -0.9);
  CHECK(found.coefficients[0] > -1);
}

TEST_CASE("runs of seven rows show the coefficient as well as one of their length in all, without bias") {
  double sum = 0, mean = 0;
  int const series = 40;
  double const c = 0.7;
  for (int k = 0; k < series; ++k) {
    // Each run is cut out of a longer series: what came before it goes on in it.
    Series const made(200 + static_cast<std::uint64_t>(k), {c}, {1500});
    std::vector<Run> runs;
    Eigen::VectorXd v(1500 / 10 * 7);
    for (Eigen::Index r = 0; r < 150; ++r) {
      runs.push_back({7 * r, 7});
      v.segment(7 * r, 7) = made.v.segment(10 * r + 3, 7);
    }
    double const off = fitted_moving_average(v, runs, {{0}}).coefficients[0] - c;
    mean += off / series;
    sum += off * off / series;
  }
  double const spread = std::sqrt(sum - mean * mean);
  CHECK(std::abs(mean) < 4 * spread / std::sqrt(series));
  CHECK(spread < 0.06);  // of one run sqrt((1 - c^2)/1050) = 0.022; seven rows show less of a zero at 0.7
}

TEST_CASE("an estimate from short runs is where the likelihood is largest") {
  Series const made(300, {0.7}, {1500});
  std::vector<Run> runs;
  Eigen::VectorXd v(5 * 300);
  for (Eigen::Index r = 0; r < 300; ++r) {
    runs.push_back({5 * r, 5});
    v.segment(5 * r, 5) = made.v.segment(5 * r, 5);
  }
  auto const minus_twice = [&](double c) {
    MovingAverage const average{{c}};
    return 1500 * std::log(average.errors(v, runs).squares()) + average.log_determinant(runs);
  };
  double const found = fitted_moving_average(v, runs, {{0}}).coefficients[0], step = 1e-4;
  double const slope = (minus_twice(found + step) - minus_twice(found - step)) / (2 * step);
  double const curvature = (minus_twice(found + step) - 2 * minus_twice(found) + minus_twice(found - step)) / (step * step);
  CHECK(curvature > 0);
  CHECK(std::abs(slope / curvature) < 1e-4);
}
