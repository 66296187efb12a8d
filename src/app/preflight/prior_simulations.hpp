// Prior draws solved by whichever method follows them: steps that are too long for the fast end of a prior must not look like a
// model that fails.
#pragma once
#include <vector>

#include "app/session/fit_target.hpp"
#include "likelihood/output.hpp"

namespace sysid {

struct PriorSimulations {
  LaneArray centres;            // [R x W] of Output, SI; NaN where nothing follows the draw
  std::vector<bool> followed;   // [W] by some method: response and density are finite
  std::vector<double> density;  // [W] log likelihood with the task's own solver
  int failed_as_stated = 0;     // with that solver
  int failed_explicit = 0;      // of these with adaptive explicit steps, too
  int stiff_left = 0;           // of these open where the solver for stiff equations last began,
  int stiff_tried = 0;          // of which it has tried so many
  int stiff_followed = 0;       // and followed so many
  Ledger ledger;                // of draws that nothing follows, one failure each: the last solver's, of the first eight
  int untraced = 0;             // further ones
};

/// theta [P x W]: draws of the prior; points: the same as those of `stated`, whose first states are set. The task's own solver goes
/// first. Where that has fixed steps, adaptive explicit ones try after it; what they follow replaces what fixed steps made of it,
/// in a model of more than 64 states only where those fail. What no explicit solver follows an implicit one tries: all of these
/// draws, or as many as can be followed. Both go to 1e-4 and within a budget of work that keeps `check` below a second.
PriorSimulations simulate_prior(Session& session, FitTask const& what, std::shared_ptr<CompiledModel const> const& compiled,
                                std::shared_ptr<ParameterSpace const> const& space, std::vector<Experiment> const& experiments,
                                Output const& stated, ConstLanes theta, ConstLanes points);

}  // namespace sysid
