// A model with random states as one simulation of many lanes: each lane has random numbers of its own, as parameters that change
// from sample to sample.
#pragma once
#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "data/experiment.hpp"
#include "model/model.hpp"

namespace sysid {

/// What was random has become further parameters of the model, which hold numbers of mean 0: first those of the starts, then one of
/// each disturbance. A disturbance is sqrt(q) times its number, and stays as it is from sample to sample. In continuous time a
/// number of white noise has the variance 1/h over an interval h, so that its integral over the interval is that of white noise.
struct DrawnSimulation {
  Model model;  // without random states
  int first = 0, starts = 0;
  std::vector<bool> white;  // per disturbance: in continuous time, and not held

  /// Writes the numbers from `sample` of the experiment on to rows [first, ...) of column `lane`; those of starts always. The same
  /// for the same key.
  void write(Experiment const& experiment, int sample, StreamKey key, Lanes parameters, int lane) const;
};

/// model: without processes and algebraic unknowns.
DrawnSimulation drawn_simulation(Model model);

}  // namespace sysid
