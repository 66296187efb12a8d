// The step of a record: one rule for all that state a rate, whatever gaps there are.
#pragma once
#include <span>

namespace sysid {

struct UsualStep {
  double step = 0;    // s: the mean, which rounded times disturb least, or where there are gaps the median
  double median = 0;  // s
  int gaps = 0;       // steps longer than 1.5 medians

  bool is_gap(double each) const { return each > 1.5 * median; }
};
/// time: [N] s, N >= 2.
UsualStep usual_step(std::span<double const> time);

}  // namespace sysid
