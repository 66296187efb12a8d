// The restoring force of an oscillator along a record, and over its displacement and velocity.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// Of a mass, q'' = a(q, q', ..., x): the part of the force x that does not accelerate,
///
///   f = x - a / (da/dx)                     Masri and Caughey 1979: m q'' + f(q, q') = x,
///
/// in the unit of x. Where x pushes the other way (da/dx < 0), as the acceleration of a ground does, its sign is turned: f pulls
/// back. Where no input enters the acceleration, f = -a, the force of one unit of mass. Of coupled masses: of a spring and damper
/// between two of them, over their elongation q_i - q_j and its speed. Declared units.
struct RestoringForce {
  std::string experiment;
  std::string name;  // in the names of its figures: "y", "q[2]_q[1]"
  std::string displacement, displacement_unit, velocity, velocity_unit, force_unit;
  bool per_mass = false;

  /// Places along a record.
  struct Path {
    std::vector<double> displacement, velocity, force;
  };
  Path model;                  // along the trajectory of the draw that moves nearest to the mean of all
  Path data;                   // of the measured samples, smoothed and differentiated; empty: the noise leaves nothing to see
  int half_width = 0;          // of what is fitted to the samples by which that was done
  bool accelerometer = false;  // data: force from measured accelerations, in place of that, at the places of the model
  std::string why_no_data;     // a clause; empty when there are data

  /// f over a grid of displacements and velocities at the same draw: rows of displacement, [rows x columns]. Empty where f depends
  /// on more than the two, as of a hysteresis.
  std::vector<double> grid_displacement, grid_velocity;
  std::vector<std::vector<double>> surface;
};

}  // namespace sysid
