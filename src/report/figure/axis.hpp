// An axis for a small panel.
#pragma once
#include "report/figure/plot.hpp"

namespace sysid::plot {

/// As `axis`, its numbers counted from the digits that all in the range share, however wide it is: shorter where those are many.
Axis counted_axis(double low, double high, int count, double margin = 0);

}  // namespace sysid::plot
