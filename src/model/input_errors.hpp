// Inputs that were measured with errors: the model reads the record plus what it lacks to the true input, which is a disturbance.
#pragma once
#include <span>
#include <variant>

#include "model/model.hpp"

namespace sysid {

/// Why a model cannot read an input with an error.
struct InputErrorProblem {
  enum class Kind {
    rate,        // it reads the derivative of the input in time
    channel,     // a channel reads the input itself: `index`
    nonlinear,   // in continuous time derivatives are not linear in the input, `node`
    no_states,   // its rows are independent
    processes,   // it has Gaussian processes,
    constraints  // or algebraic unknowns or constraints
  };
  Kind kind = Kind::rate;
  int input = 0;
  int index = -1;
  NodeId node = 0;
};

/// sd: of the error of each input, SI; 0: none. Errors of samples are independent.
///
/// In continuous time an error is held from sample to sample, whatever rule the input follows, and enters the derivatives; derived
/// quantities read the record as it was measured. In discrete time it is a state of one sample, and those before it registers, read
/// wherever the input is.
std::variant<Model, InputErrorProblem> with_input_errors(Model model, std::span<double const> sd);

}  // namespace sysid
