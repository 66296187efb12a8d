// Filters on signals whose derivatives are known.
#include "regression/column/smoothing.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/numeric/random.hpp"
#include "regression/column/signals.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::regression;

TEST_CASE("Savitzky and Golay's weights are exact on polynomials of their degree, and give the published smoother") {
  // p(t) = 1 - t + 2 t^2 - 0.5 t^3 + 0.1 t^4 at t = 0: 1, -1, 4, -3
  double const derivatives[] = {1, -1, 4, -3};
  for (int derivative = 0; derivative <= 3; ++derivative) {
    std::vector<double> const weights = savitzky_golay_weights(7, 4, derivative);
    double sum = 0;
    for (int i = -7; i <= 7; ++i) {
      double const t = i;
      sum += weights[static_cast<std::size_t>(i + 7)] * (1 - t + 2 * t * t - 0.5 * t * t * t + 0.1 * t * t * t * t);
    }
    CHECK(sum == doctest::Approx(derivatives[derivative]).epsilon(1e-10));
  }
  // Five points, quadratic: (-3, 12, 17, 12, -3)/35 (Savitzky and Golay 1964, table I).
  std::vector<double> const five = savitzky_golay_weights(2, 2, 0);
  for (int k = 0; k < 5; ++k) CHECK(five[static_cast<std::size_t>(k)] == relative((double[]){-3, 12, 17, 12, -3}[k] / 35, 1e-12));
}

TEST_CASE("a filter says nothing near ends and missing samples") {
  std::vector<double> samples(20, 1.0);
  samples[10] = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> const out = filtered(samples, savitzky_golay_weights(2, 2, 0), 1);
  for (std::size_t i = 0; i < 20; ++i) CHECK(std::isfinite(out[i]) == (i >= 2 && i < 18 && (i < 8 || i > 12)));
}

TEST_CASE("a smoothing spline keeps parabolas under any penalty") {
  std::vector<double> samples;
  for (int i = 0; i < 40; ++i) samples.push_back(3 - 0.5 * i + 0.25 * i * i);
  samples[17] = std::numeric_limits<double>::quiet_NaN();
  for (double const penalty : {1e-3, 1.0, 1e5}) {
    SmoothingSpline const spline(samples, penalty);
    std::vector<double> const value = spline.derivative(0), slope = spline.derivative(1), curvature = spline.derivative(2);
    for (int i = 0; i < 40; ++i) {
      auto const k = static_cast<std::size_t>(i);
      CHECK(value[k] == doctest::Approx(3 - 0.5 * i + 0.25 * i * i).epsilon(1e-7));
      CHECK(slope[k] == doctest::Approx(-0.5 + 0.5 * i).epsilon(1e-6).scale(1));
      CHECK(curvature[k] == doctest::Approx(0.5).epsilon(1e-5));
    }
  }
}

TEST_CASE("the penalty for a noise leaves a residual of that noise") {
  Stream noise({5, Purpose::test, 0, 0});
  std::vector<double> samples;
  for (int i = 0; i < 400; ++i) samples.push_back(std::sin(0.05 * i) + 0.02 * noise.normal());
  std::vector<double> const smooth = SmoothingSpline(samples, penalty_for_noise(samples, 0.02)).derivative(0);
  double squares = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) squares += (samples[i] - smooth[i]) * (samples[i] - smooth[i]) / 400;
  CHECK(std::sqrt(squares) == relative(0.02, 1e-6));
}

TEST_CASE("noise that grows with a motion that dies away is estimated by its law, which the taper of the spectrum would miss") {
  constexpr int rows = 600;
  std::vector<double> samples, dying, shape;
  Stream noise({7, Purpose::test, 0, 0});
  for (int i = 0; i < rows; ++i) {
    dying.push_back(std::exp(-0.01 * i) * std::sin(2 * M_PI * i / 90));
    shape.push_back(std::hypot(dying.back(), 0.05));
  }
  double mean = 0;
  for (double const each : shape) mean += each * each / rows;
  for (double& each : shape) each /= std::sqrt(mean);
  for (std::size_t i = 0; i < rows; ++i) samples.push_back(dying[i] + 0.01 * shape[i] * noise.normal());
  std::vector<ChannelSamples> const alike = {{samples}}, growing = {{samples, shape}};
  CHECK(estimated_noise(growing) == relative(0.01, 0.15));
  CHECK(estimated_noise(alike) < 0.006);
  // Of noise that is alike in all samples both are the same.
  std::vector<double> const ones(rows, 1.0);
  std::vector<ChannelSamples> const stated = {{samples, ones}};
  CHECK(estimated_noise(stated) == relative(estimated_noise(alike), 1e-12));
}

TEST_CASE("noise is estimated from differences, the fastest period from the spectrum") {
  Stream noise({6, Purpose::test, 0, 0});
  std::vector<double> samples;
  for (int i = 0; i < 2000; ++i) samples.push_back(std::sin(2 * M_PI * i / 80) + 0.01 * noise.normal());
  // The estimate's own relative sd is about sqrt(1.8 / 2000) = 3 %: sixth differences of neighbours correlate.
  CHECK(estimated_noise(samples) == relative(0.01, 0.12));
  // Of a sine all power lies at its frequency; the taper spreads it over the neighbouring lines of the spectrum, 2 in 25.
  double const period = fastest_period(samples, 0.5);
  CHECK(period <= 40);
  CHECK(period > 40 / (1 + 3.0 / 25));
  CHECK(std::isinf(fastest_period(std::vector<double>(50, 2.0), 1)));
}
