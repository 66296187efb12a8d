// What simulates one experiment of a target.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/model_target.hpp"
#include "likelihood/read_coordinates.hpp"
#include "likelihood/start_state.hpp"

namespace sysid {

struct ModelTarget::Part {
  Simulator likelihood, residuals;
  std::unique_ptr<StartState> start;
  ReadByExperiment read;
  Lazily<Simulator> squares, gradient;  // where the compiled model has derivatives
};

}  // namespace sysid
