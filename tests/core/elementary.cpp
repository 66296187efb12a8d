// Elementary functions: bit-equal in every form, within an ulp of the exact value, and right at their special arguments.
#include "core/numeric/elementary.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

struct UnaryRow {
  char const* name;
  elementary::Unary scalar;
  elementary::UnaryLanes lanes;
  long double (*exact)(long double);
  double low, high;
};

#define ROW(name, low, high)                                                                                 \
  {                                                                                                          \
#name, elementary::name, elementary::name##_lanes, [](long double x) { return std::name(x); }, low, high \
  }
UnaryRow const rows[] = {
    ROW(exp, -700, 700), ROW(expm1, -30, 700), ROW(log, 1e-300, 10), ROW(log1p, -0.999, 10), ROW(log10, 1e-300, 10),
    ROW(sin, -1e4, 1e4), ROW(cos, -1e4, 1e4),  ROW(tan, -10, 10),    ROW(asin, -1, 1),       ROW(acos, -1, 1),
    ROW(atan, -20, 20),  ROW(sinh, -20, 20),   ROW(cosh, -20, 20),   ROW(tanh, -5, 5),       ROW(erf, -4, 4),
    ROW(erfc, -4, 25),   ROW(lgamma, 3, 170),
};
#undef ROW

std::vector<InstructionSet> supported() {
  if (supported_instruction_set() == InstructionSet::avx512) return {InstructionSet::avx2, InstructionSet::avx512};
  return {narrowest_instruction_set};
}

struct Forced {
  explicit Forced(InstructionSet set) : before(instruction_set()) { force_instruction_set(set); }
  ~Forced() { force_instruction_set(before); }
  InstructionSet before;
};

std::vector<double> arguments(double low, double high, int count, std::uint64_t index) {
  Stream stream({.seed = 1, .purpose = Purpose::test, .index = index, .step = 0});
  std::vector<double> x;
  for (int i = 0; i < count; ++i) x.push_back(low + (high - low) * stream.uniform());
  for (double const special : {0.0, -0.0, 1.0, -1.0, 0.5, 1e-310, -1e300, std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    x.push_back(special);
  return x;
}

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b); }

double ulps(double value, long double exact) {
  double const rounded = std::abs(static_cast<double>(exact));
  double const spacing = std::nextafter(rounded, std::numeric_limits<double>::infinity()) - rounded;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / spacing);
}

}  // namespace

TEST_CASE("lane forms equal the scalar form bit for bit, for every width and instruction set") {
  for (InstructionSet const set : supported()) {
    Forced const forced(set);
    for (UnaryRow const& row : rows) {
      CAPTURE(row.name);
      std::vector<double> const x = arguments(row.low, row.high, 200, 1);
      for (int width : {1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 31, static_cast<int>(x.size())}) {
        std::vector<double> out(static_cast<std::size_t>(width));
        double const* begin = x.data() + (x.size() - static_cast<std::size_t>(width));
        row.lanes(begin, out.data(), width);
        for (int i = 0; i < width; ++i) CHECK(same(out[static_cast<std::size_t>(i)], row.scalar(begin[i])));
      }
    }
    std::vector<double> const x = arguments(0, 30, 300, 2), y = arguments(-8, 8, 300, 3);
    for (int width : {1, 3, 4, 6, 8, 11, 310}) {
      std::vector<double> power(static_cast<std::size_t>(width)), angle(static_cast<std::size_t>(width));
      elementary::pow_lanes(x.data(), y.data(), power.data(), width);
      elementary::atan2_lanes(y.data(), x.data(), angle.data(), width);
      for (std::size_t i = 0; i < power.size(); ++i) {
        CHECK(same(power[i], elementary::pow(x[i], y[i])));
        CHECK(same(angle[i], elementary::atan2(y[i], x[i])));
      }
    }
  }
}

TEST_CASE("values are within SLEEF's bound of the exact ones") {
  for (UnaryRow const& row : rows) {
    CAPTURE(row.name);
    double worst = 0;
    std::vector<double> const x = arguments(row.low, row.high, 5000, 4);
    for (std::size_t i = 0; i < 5000; ++i) worst = std::max(worst, ulps(row.scalar(x[i]), row.exact(x[i])));
    CHECK(worst < (std::string_view(row.name) == "erfc" ? 1.5 : 1.0));
  }
  double worst = 0;
  std::vector<double> const x = arguments(0, 30, 5000, 5), y = arguments(-20, 20, 5000, 6);
  for (std::size_t i = 0; i < 5000; ++i) {
    worst = std::max(worst,
                     ulps(elementary::pow(x[i], y[i]), std::pow(static_cast<long double>(x[i]), static_cast<long double>(y[i]))));
    worst = std::max(
        worst, ulps(elementary::atan2(y[i], x[i]), std::atan2(static_cast<long double>(y[i]), static_cast<long double>(x[i]))));
  }
  CHECK(worst < 1.0);
}

TEST_CASE("special arguments give the values of IEC 60559") {
  double const infinity = std::numeric_limits<double>::infinity();
  CHECK(elementary::exp(-infinity) == 0);
  CHECK(elementary::exp(800.0) == infinity);
  CHECK(elementary::log(0.0) == -infinity);
  CHECK(std::isnan(elementary::log(-1.0)));
  CHECK(elementary::pow(0.0, 0.0) == 1);
  CHECK(elementary::pow(0.0, 0.7) == 0);
  CHECK(elementary::pow(0.0, -0.5) == infinity);
  CHECK(elementary::pow(-2.0, 3.0) == -8);
  CHECK(std::isnan(elementary::pow(-2.0, 0.5)));
  CHECK(elementary::tanh(infinity) == 1);
  CHECK(elementary::lgamma(1.0) == 0);
  CHECK(elementary::lgamma(2.0) == 0);
}
