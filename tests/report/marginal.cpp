// Kernel estimates of known densities.
#include "report/figure/marginal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::vector<double> normals(int count) {
  Stream stream({5, Purpose::test, 0, 0});
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(stream.normal());
  std::sort(out.begin(), out.end());
  return out;
}

double integral(std::vector<double> const& density, double from, double to) {
  double sum = 0;
  for (std::size_t k = 0; k + 1 < density.size(); ++k) sum += (density[k] + density[k + 1]) / 2;
  return sum * (to - from) / static_cast<double>(density.size() - 1);
}

}  // namespace

TEST_CASE("the kernel density of normal draws is theirs, to its own bias and error") {
  int const n = 20000;
  std::vector<double> const draws = normals(n);
  std::vector<double> const density = kernel_density(draws, n, -5, 5, 201, -infinity, infinity);
  REQUIRE(density.size() == 201);
  CHECK(integral(density, -5, 5) == doctest::Approx(1).epsilon(0.002));
  double const h = kernel_width(draws, n);
  CHECK(h == relative(0.9 * std::pow(n, -0.2), 0.05));
  for (int k = 0; k < 201; ++k) {
    double const x = -5 + k * 0.05, exact = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
    // Silverman 1986, eqs. 3.13 and 3.14: bias h^2 f''/2, variance f/(2 sqrt(pi) n h).
    double const bias = std::fabs(h * h * (x * x - 1) * exact / 2),
                 sd = std::sqrt(exact / (2 * std::sqrt(std::numbers::pi) * n * h));
    CHECK(std::fabs(density[static_cast<std::size_t>(k)] - exact) < bias + 5 * sd + 2e-3);
  }
}

TEST_CASE("at a bound the density neither leaks nor sinks") {
  std::vector<double> draws = normals(20000);
  for (double& each : draws) each = std::fabs(each);
  std::sort(draws.begin(), draws.end());
  std::vector<double> const density = kernel_density(draws, 20000, -1, 5, 241, 0, infinity);
  CHECK(density[20] == 0);  // -0.5
  CHECK(density[40] == doctest::Approx(std::sqrt(2 / std::numbers::pi)).epsilon(0.06));
  std::vector<double> const leaking = kernel_density(draws, 20000, -1, 5, 241, -infinity, infinity);
  CHECK(leaking[40] < 0.6 * density[40]);
}

TEST_CASE("draws that do not vary have no density") {
  CHECK(kernel_density({2, 2, 2, 2}, 4, 1, 3, 11, -infinity, infinity).empty());
  CHECK(kernel_density({2}, 1, 1, 3, 11, -infinity, infinity).empty());
}

TEST_CASE("the end of a support is found where the density ends, and nowhere else") {
  auto const uniform = [](double x) { return x > 1 && x < 3 ? 0.5 : 0.0; };
  CHECK(support_end(uniform, 1.5, 0) == doctest::Approx(1).epsilon(1e-12));
  CHECK(support_end(uniform, 1.5, 9) == doctest::Approx(3).epsilon(1e-12));
  CHECK(support_end(uniform, 1.5, 1.2) == 1.2);
}

TEST_CASE("a histogram holds all draws, its outline the part that is asked for") {
  Histogram const histogram(normals(1000), -5, 5);
  double mass = 0;
  for (double const each : histogram.density) mass += each * histogram.width;
  CHECK(mass == doctest::Approx(1).epsilon(1e-12));
  auto const outline = histogram.outline(-0.7, 0.9);
  CHECK(outline.front().first == -0.7);
  CHECK(outline.back().first == 0.9);
}
