// Noise that is a moving average: removed by its own coefficients, found from a long series, and by an independent formula.
#include "regression/column/moving_average.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/numeric/random.hpp"

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

TEST_CASE("divided by its own polynomial a moving average is what it was made of, run by run") {
  std::vector<double> const c = {0.9, -0.3, 0.1};
  Series const series(1, c, {40, 2, 25});
  CHECK((MovingAverage{c}.divided(series.v, series.runs) - series.e).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((MovingAverage{}.divided(series.v, series.runs) - series.v).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("slopes are the derivatives of -e by the coefficients") {
  std::vector<double> const c = {0.5, 0.2};
  Series const series(2, {0.7, -0.1}, {30, 20});
  Eigen::VectorXd const e = MovingAverage{c}.divided(series.v, series.runs);
  Eigen::MatrixXd const slopes = MovingAverage{c}.slopes(e, series.runs);
  double const step = 1e-6;
  for (std::size_t k = 0; k < c.size(); ++k) {
    std::vector<double> more = c, less = c;
    more[k] += step;
    less[k] -= step;
    Eigen::VectorXd const by_difference =
        (MovingAverage{less}.divided(series.v, series.runs) - MovingAverage{more}.divided(series.v, series.runs)) / (2 * step);
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
