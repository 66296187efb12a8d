// A model with random states as its particles are simulated: what is random in it becomes further states and parameters that hold
// standard normal numbers.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// One disturbance, q its intensity and xi standard normal numbers. White noise is a straight line in each step of the solver, of
/// length h; where the solver chooses its steps itself, in each sampling interval:
///
///   white:  sqrt(q/h) (xi_1 + sqrt(3) (2 s/h - 1) xi_2), s in [0, h]        Foster, Lyons, Oberhauser 2020, sec. 2
///   held, and in discrete time:  sqrt(q) xi_1, the same in the whole sampling interval
///
/// The line has the joint distribution of white noise in its integral over h and in the integral of that: velocity and displacement
/// of a free mass are exact.
struct ParticleNoise {
  int state = 0;          // the row of its value; of a white one the row of its rate follows
  bool white = false;     // in continuous time
  bool observed = false;  // a channel reads it at the sample where the interval begins
  int numbers() const { return white ? 2 : 1; }
};

struct ParticleModel {
  Model model;     // nothing in it is random; its further states come behind its own, its further parameters too
  int states = 0;  // of its own
  int starts = 0;  // random initial states: parameters from `first_start` on are their standard normal numbers
  int first_start = 0;
  std::vector<ParticleNoise> noises;
  int numbers = 0;  // that a particle takes for a step
  /// Records: per channel the log density of its sample, of the declared unit.
  std::shared_ptr<SimulationProgram const> densities;
};

/// model: filtered, without processes and algebraic unknowns. method: of the solver.
std::shared_ptr<ParticleModel const> particle_model(Model model, std::string const& method);

}  // namespace sysid
