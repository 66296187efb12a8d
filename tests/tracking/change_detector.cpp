// Which statistics are compared with each other.
#include "tracking/change_detector.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace sysid;

namespace {

/// Two parameters without states that no sample corrects, from row 0 on.
class TwoParameters {
 public:
  TwoParameters() : detector_(0, 2, 1e-5, 2048) {
    detector_.set_scales({100, 100});
    detector_.keep(0, zeros_, zeros_);
  }
  void observe(double innovation, double first_slope, double second_slope) {
    double const slopes[] = {first_slope, second_slope};
    detector_.observe({innovation, 1, slopes, zeros_.data()});
  }
  ChangeDetector& detector() { return detector_; }

 private:
  std::vector<double> zeros_ = {0, 0};
  ChangeDetector detector_;
};

}  // namespace

TEST_CASE("a sample alone that speaks for another parameter does not hold a change back") {
  TwoParameters two;
  two.observe(7.8, 1, 0);
  for (int i = 0; i < 50; ++i) two.observe(1, 0, 1);
  auto const jump = two.detector().detect();
  REQUIRE(jump);
  CHECK(jump->parameter == 1);
  CHECK(jump->statistic == doctest::Approx(std::sqrt(50.0)));
  CHECK(jump->other_statistic == doctest::Approx(7.8 / 2));
}

TEST_CASE("what a louder noise explains counts as no change of a parameter") {
  TwoParameters two;
  for (int i = 0; i < 40; ++i) two.observe(i % 2 == 0 ? 5 : -3, 1, 0);
  CHECK(!two.detector().detect());
  CHECK(two.detector().explained() == 0);
}
