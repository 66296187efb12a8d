// How far modes have moved when a target changed a little.
#pragma once
#include <span>
#include <vector>

#include "result/mode.hpp"
#include "result/parameter_info.hpp"

namespace sysid {

/// How far a parameter's limits, its value plus and minus its sd, lie apart in two modes, in units of `before`'s sd.
struct Move {
  int parameter = 0;
  double value = 0;  // |change of value|
  double width = 0;  // |change of sd|

  double size() const { return value + width; }
};

/// Of every parameter that has an sd, in `before`, the mode whose sds are the measure, or else in `after`; both parts infinite
/// where a mode is not finite.
///
/// One is what `refit` made of the other on another target; gain: by how much that raised its log density there. Sds are not
/// believed blindly. At a bound they mean nothing: a parameter that is there in both modes has not moved. Along a direction that
/// nothing resists they are the prior's: their change is none, and where `after` is resisted its sds are the measure, since a step
/// that is too large may tie what the data leave open. And where the curvature is right, a move by a sds gains a^2/2 at least:
/// where less than a quarter of that was gained, the curvature is wrong, and the move is what the gain allows, sqrt(2 gain). So it
/// is for what moves most where a direction is flat in either mode and more than 1/2 was gained though nothing moves by a fifth of
/// that.
std::vector<Move> moves_between(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain);
/// The largest of them.
Move largest_move(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain);

}  // namespace sysid
