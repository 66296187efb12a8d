// Motions of found equations along rows that were held out, from a start that the first of these set.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "data/experiment.hpp"
#include "model/model.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// From row `first` of an experiment to its last row. SI.
struct FreeMotion {
  int experiment = 0, first = 0;
  int window = 0;  // rows that set the start
  std::vector<std::vector<double>> channels;
};

/// Ten times the range of what is measured, about its middle; everything where nothing is.
class Bounds {
 public:
  explicit Bounds(std::vector<double> const& measured);
  bool hold(double value) const;

 private:
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
};

/// As figures and files show it, in declared units: NaN in all channels from the first row on in which one is not finite or leaves
/// its bounds. measured: inputs and channels of the experiment. channels: of `measured`, those of the run.
Prediction shown_motion(FreeMotion const& run, Experiment const& experiment, Model const& measured,
                        std::span<std::size_t const> channels);

}  // namespace sysid
