// A report as a Duffing fit would fill it, with draws made up from a known normal: for the tests of all writers.
#pragma once
#include "result/report.hpp"

namespace sysid::example {

/// Four chains of `draws` correlated draws of m, c, k, k3 and beta and a fit over 500 samples of 1 ms.
Report duffing(int draws = 500);

}  // namespace sysid::example
