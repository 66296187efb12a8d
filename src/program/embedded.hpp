// Embedded Runge-Kutta methods with step control, written as expressions: one attempt at a step is one pass of straight-line code,
// in which every lane has its own step. A lane that has reached the end of the interval, or whose attempt is rejected, keeps its
// states by selection, so lanes never wait for data of one another.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "expression/graph.hpp"
#include "solver/embedded_method.hpp"

namespace sysid {

/// The inputs' polynomials have at most this degree.
constexpr int largest_input_degree = 7;
constexpr int most_surfaces = 16;

/// Registers of step control, one value per lane: leaves of kind `control`. `rest` begins the largest magnitudes that the states
/// have reached, one each, then the sides of the switching surfaces.
enum class Control { position, step, aim, hunts, rest };
/// What a lane's attempts read of the data, the same for all lanes: leaves of kind `interval`.
enum class IntervalData { begin, length, relative, absolute };

/// The values after one attempt.
///
///   position   of the lane in the interval, 0 to 1; 1: arrived, nothing changes any more
///   step       [s] that the next step would like to take
///   aim        [s] a shorter step that ends at a kink; the largest number: none
///   hunts      attempts made to end this step at a kink
///   sides      -1 or 1: the side of each switching surface of the derivative that the lane is on
struct Attempt {
  std::vector<NodeId> states;
  std::vector<NodeId> control;  // in the order of Control
};

/// One attempt. derivative: expressions of state, input, input_rate, time and parameter leaves.
///
/// Within a step every abs, sign, min, max and comparison is held on the side that the lane is on, so the step is smooth. A step
/// that would end on another side is shortened until it ends there, and the side changes with it. More than `most_surfaces` of them
/// are left to the error estimate. A solution that cannot leave a surface (dry friction that sticks) makes no progress there.
///
///   r_i = error_i / (near_zero_i + relative max(|y_i|, |y_i new|)),  accepted when  mean r_i^2 <= 1,
///   next step = step * min(5, max(0.2, 0.9 (mean r^2)^(-1/(2 order))))               Hairer, Norsett & Wanner 1993, II.4
///
/// near_zero_i: SolverSettings::near_zero of the largest size reached. The mean is over the states that have an error: not over
/// what is remembered from sample to sample, nor over constants.
Attempt attempt(Graph& graph, EmbeddedMethod const& method, std::span<NodeId const> derivative);

}  // namespace sysid
