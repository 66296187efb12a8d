// The equations of a fitted model that a disturbance is added to, as they stand in the user's text.
#pragma once
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "load/load.hpp"

namespace sysid {

struct DisturbedEquation {
  Span place;                 // of the whole equation
  std::string left, right;    // its sides as written; the right one is empty where it is 0
  bool right_closed = false;  // a sum may follow the right side without parentheses
  std::string name;           // of the disturbance, free in its model
  std::string sizes;          // "(3)" of a vector equation, else empty
  std::string inertia;        // an expression of the size that a disturbance may have: in continuous time the terms of the highest
                              // derivatives, in discrete time what is determined
  bool discrete = false;
  bool memory = false;  // in continuous time: the disturbance lasts for some samples, because a channel reads it

  bool white() const { return !discrete && !memory; }
  std::string parameter() const { return name + (white() ? "_intensity" : "_sd"); }
  /// A derived quantity that has the value and the unit of `inertia`.
  std::string probe() const { return name + "_probe"; }
};

/// Of second-order equations, and those of higher order, each one that holds the highest derivative of a state; where a model has
/// none, its first-order equations; in discrete time all. Those of parts are among them where their models stand in the file.
/// UserError, with its place, where the model of the fit can have no disturbance, has one already or stands in a module.
std::vector<DisturbedEquation> disturbed_equations(Source const& source, CheckedFile const& file, Task const& fit);

}  // namespace sysid
