// Variates that several distributions are made of: moments to their standard errors.
#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

using namespace sysid;

TEST_CASE("gamma variates have the mean and the variance of their shape") {
  // n draws: the mean of a gamma variate has standard error sqrt(shape/n), the variance sqrt((2 shape^2 + 6 shape)/n). Five of
  // each.
  constexpr int n = 100'000;
  for (double const shape : {0.3, 1.0, 2.5, 40.0}) {
    Stream stream(StreamKey{.seed = 77});
    double sum = 0, square = 0;
    for (int i = 0; i < n; ++i) {
      double const x = elementary::exp(log_standard_gamma(shape, stream));
      sum += x;
      square += (x - shape) * (x - shape);
    }
    CAPTURE(shape);
    CHECK(std::fabs(sum / n - shape) < 5 * std::sqrt(shape / n));
    CHECK(std::fabs(square / n - shape) < 5 * std::sqrt((2 * shape * shape + 6 * shape) / n));
  }
}

TEST_CASE("a gamma variate of a tiny shape keeps its logarithm though it underflows itself") {
  // log X = log X' + log(U)/shape with E log U = -1: about -1/shape, far below the -745 where exp ends.
  Stream stream(StreamKey{.seed = 5});
  double sum = 0;
  constexpr int n = 10'000;
  for (int i = 0; i < n; ++i) sum += log_standard_gamma(1e-4, stream);
  // psi(1e-4) = -1e4 - 0.577; the sd of log U / shape is 1e4.
  CHECK(std::fabs(sum / n + 1e4) < 5 * 1e4 / std::sqrt(n));
}
