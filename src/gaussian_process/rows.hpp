// What the files of one kernel each share: their rows, and scaled distances.
#pragma once
#include "gaussian_process/jet.hpp"
#include "gaussian_process/kernel.hpp"
#include "gaussian_process/list.hpp"

namespace sysid::gaussian_process {

#define DECLARE_ROW(name) KernelRow name##_kernel();
SYSID_KERNELS(DECLARE_ROW)
#undef DECLARE_ROW

/// amplitude and one length-scale per input: what most stationary kernels have.
constexpr HyperParameterRow amplitude_and_lengths[] = {{"amplitude", false, {.output = 1}}, {"length", true, {.input = 1}}};

/// out_i = sum over d of ((left_id - right_d)/length_d)^2.
void squared_distances(Strip const& strip, Numbers lengths, double* out);

/// The same of one pair of points.
Jet squared_distance(Jets left, Jets right, Jets lengths);

/// gradient_d += sum over i of weights_i ((left_id - right_d)/length_d)^2: the derivative of a function of the scaled distance r in
/// the logarithms of its lengths, where weights_i holds -(dk/dr)/r of it.
void add_length_gradient(Strip const& strip, Numbers lengths, double const* weights, double* gradient);

}  // namespace sysid::gaussian_process
