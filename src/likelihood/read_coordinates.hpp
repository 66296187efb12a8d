// Which coordinates the simulations of an experiment read: it is simulated again only where one of these differs.
#pragma once
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {

/// Ascending.
struct ReadByExperiment {
  std::vector<int> parameters;  // of the model: states, their starts (also the first guess of an estimated one) or the density of a
                                // channel read them
  std::vector<int> coordinates;  // that their values come from; those of priors alone are not among them
};
ReadByExperiment read_by(CompiledModel const& compiled, ParameterSpace const& space, int experiment);

}  // namespace sysid
