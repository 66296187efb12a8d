// How much a measured channel and its derivatives vary: the scale for starts and noise before the first fit.
#pragma once
#include <cstddef>
#include <vector>

#include "experiment/experiments.hpp"

namespace sysid {

/// Of one channel over all experiments, coherent SI.
struct Motion {
  double first = 0;          // what was measured first, mean over the experiments
  std::vector<double> size;  // [order]: root mean square of the k-th difference quotient, of the values themselves about their
                             // mean; the largest of the experiments
};

Motion motion_of(std::vector<ExperimentData> const& data, std::size_t channel, int orders);

}  // namespace sysid
