// What estimates of a likelihood say of a filter, where their mean and scatter are made here.
#include "diagnostics/tolerance/filter_comparison.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace sysid;

namespace {

/// Around `middle`, by as much on either side.
std::vector<double> scattered(double middle, double by) {
  std::vector<double> estimates;
  for (int k = 0; k < 16; ++k) estimates.push_back(middle + (k % 2 == 0 ? by : -by));
  return estimates;
}

FilterComparison with_offsets(std::vector<double> const& offsets, double scatter = 0.1) {
  std::vector<FilterOffset> all;
  for (double const each : offsets) all.push_back(filter_offset(scattered(-50 + each, scatter), -50));
  return compare_filter(std::move(all));
}

}  // namespace

TEST_CASE("the offset of a filter is that of the mean of estimates, with its error") {
  FilterOffset const offset = filter_offset(scattered(-50, 0.5), -53);
  // Estimates exp(+-0.5): mean cosh(0.5), sd of 16 of them sinh(0.5) sqrt(16/15).
  CHECK(offset.value == doctest::Approx(3 + std::log(std::cosh(0.5))));
  CHECK(offset.error == doctest::Approx(std::tanh(0.5) / std::sqrt(15)));
  CHECK(offset.known);
  CHECK_FALSE(filter_offset(scattered(-50, 3), -53).known);
  CHECK_FALSE(filter_offset(std::vector<double>(16, -INFINITY), -53).known);
}

TEST_CASE("a filter holds where its offset is small and the same everywhere") {
  CHECK(with_offsets({0.3, -0.2, 0.1, 0}).holds());
  CHECK(with_offsets({1.5, 1.4, 1.6, 1.5}).holds());
  FilterComparison const shifted = with_offsets({8, 8.1, 7.9, 8});
  CHECK(shifted.worst >= 0);
  CHECK(shifted.change == 0);
  FilterComparison const bent = with_offsets({-0.9, 0.9, 0, 0});
  CHECK(bent.worst < 0);
  CHECK(bent.change > 1);
}

TEST_CASE("estimates that scatter decide where the difference is larger than what they may miss") {
  CHECK_FALSE(with_offsets({1, 2, 0, 1}, 3).known());
  CHECK(with_offsets({1, 2, 0, 1}, 3).holds());
  CHECK(with_offsets({40, 1, 0, 1}, 3).worst == 0);
  CHECK(with_offsets({-10, 1, 0, 1}, 3).holds());
  CHECK(with_offsets({-900, 1, 0, 1}, 3).worst == 0);
  CHECK(with_offsets({-INFINITY, 1, 0, 1}).holds());
}

TEST_CASE("the cure of a filter is one that particles confirm") {
  FilterComparison const off = with_offsets({8, 8.1, 7.9, 8}), bent = with_offsets({8, 2, 5, 6}), good = with_offsets({0, 0, 0, 0}),
                         open = with_offsets({0, 0, 0, 0}, 3);
  auto const cure = [&](FilterComparison const* unscented) {
    return filter_finding(off, FilterRule::extended, unscented, {"draw", ""}).help;
  };
  CHECK(cure(&good).find("`filter = unscented`, which particles confirm") != std::string::npos);
  for (FilterComparison const* unscented : {&off, &open, static_cast<FilterComparison const*>(nullptr)})
    CHECK(cure(unscented).starts_with("fit with `mh` and `filter = particle`"));
  CHECK(filter_finding(off, FilterRule::extended, &good, {"draw", ""}).severity == Severity::warning);
  CHECK(filter_finding(bent, FilterRule::unscented, nullptr, {"draw", ""}).severity == Severity::error);
}
