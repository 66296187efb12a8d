// The estimated Gaussian processes at samples, as functions of their inputs.
#pragma once
#include <vector>

#include "likelihood/process/process_target.hpp"
#include "result/draws.hpp"
#include "result/function.hpp"

namespace sysid {

/// The process of every channel that has one alone, along each of its inputs over the range that the fitted samples reach, the
/// others at their medians there: given the fitted samples, mean and variance over `draws` (of all parameters, declared; all: their
/// space),
///
///   mean = E m_d,   variance = E v_d + var m_d,   90 % by the normal of the two
///
/// Processes whose covariances cannot be decomposed are left out, and those that share a channel, of which the samples tell the
/// sum.
std::vector<FunctionReport> process_functions(ProcessTarget const& target, ParameterSpace const& all, Draws const& draws);

}  // namespace sysid
