// The program whose records the smoother goes back over.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/smoothing/backward_pass.hpp"
#include "program/kernel.hpp"
#include "program/uniform_leaf.hpp"

namespace sysid {

/// A state, a quantity derived from states, or a disturbance of white noise, of which the mean over a sampling interval is
/// smoothed.
struct SmoothedKind {
  enum class Kind { state, derived, average };
  Kind kind;
  int index;  // state, derived quantity, disturbance of the model
};

struct SmoothingProgram {
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<SimulationProgram const> program;
  SmoothingRecords layout;
  /// What is shown: states, then disturbances that are none, then quantities derived from states. In discrete time, where states
  /// are what is remembered, only those that are a disturbance.
  std::vector<SmoothedKind> shown;
  /// Value and slopes by the states of each derived quantity that is shown, of the states and of `leaves`.
  Kernel derived;
  std::vector<UniformLeaf> leaves;
};

/// Of a model with random states.
std::shared_ptr<SmoothingProgram const> compile_smoothing(std::shared_ptr<CompiledModel const> compiled);

}  // namespace sysid
