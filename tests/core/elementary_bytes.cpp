// Elementary functions on a processor equal those on every other: digests of values, recorded once on x86-64 with AVX-512.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/elementary_list.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

constexpr int count = 1'000'000;

/// A quarter each in (-1, 1), (-20, 20) and (0, 1000), and over a thousand binary orders of magnitude.
std::vector<double> spread_arguments() {
  Stream stream({.seed = 3, .purpose = Purpose::test, .index = 0, .step = 0});
  std::vector<double> x;
  for (int i = 0; i < count; ++i) {
    double const u = stream.uniform(), around_zero = 2 * u - 1;
    switch (i % 4) {
      case 0:
        x.push_back(around_zero);
        break;
      case 1:
        x.push_back(20 * around_zero);
        break;
      case 2:
        x.push_back(1000 * u);
        break;
      default:
        x.push_back(std::ldexp(around_zero, static_cast<int>(stream.below(1000)) - 500));
    }
  }
  return x;
}

/// FNV-1a over words; NaNs are one value.
std::uint64_t digest(std::vector<double> const& values) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (double const value : values)
    hash = (hash ^ (value != value ? 0x7ff8000000000000 : std::bit_cast<std::uint64_t>(value))) * 0x100000001b3;
  return hash;
}

std::map<std::string, std::uint64_t> const recorded = {
    {"exp", 0x0de49cd8c5f85b8c},    {"expm1", 0x54bc5fc36176bcd5}, {"log", 0xbb1ca99aa9fea111},   {"log1p", 0x41b904a8a3a2b244},
    {"log10", 0x569bb2460b9bd2ec},  {"sin", 0x904d9fd3f1869de2},   {"cos", 0x56742fd4c8cbfeb6},   {"tan", 0xae20fc27156bbb83},
    {"asin", 0x037d85f568704ba7},   {"acos", 0x21a04dc51e8b6264},  {"atan", 0xdc12d07aa1b430b0},  {"sinh", 0x0edffad726e363e8},
    {"cosh", 0x6d0c7b5ee1aae7e2},   {"tanh", 0x920edbf85aa289c9},  {"erf", 0xa952d6ae54bc27c0},   {"erfc", 0x75c7d698885b74ff},
    {"lgamma", 0x04024f0c040d3fa7}, {"pow", 0x0af71bca367eff2d},   {"atan2", 0xe9b0b931a26a91db},
};

}  // namespace

TEST_CASE("a million values of every elementary function are the bytes that were recorded") {
  std::vector<double> const x = spread_arguments();
  std::vector<double> y, out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y.push_back(20 * x[i - i % 4]);  // in (-20, 20)
#define SYSID_UNARY(name, accuracy)                      \
  elementary::name##_lanes(x.data(), out.data(), count); \
  CHECK_MESSAGE(digest(out) == recorded.at(#name), #name);
#define SYSID_BINARY(name, accuracy)                               \
  elementary::name##_lanes(x.data(), y.data(), out.data(), count); \
  CHECK_MESSAGE(digest(out) == recorded.at(#name), #name);
  SYSID_ELEMENTARY_UNARY(SYSID_UNARY)
  SYSID_ELEMENTARY_BINARY(SYSID_BINARY)
#undef SYSID_UNARY
#undef SYSID_BINARY
}
