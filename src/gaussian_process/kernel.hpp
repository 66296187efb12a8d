// A covariance function as a row of data: values, derivatives and, where they exist, a state-space form and a spectral density. One
// file and one row (gaussian_process/list.hpp) adds another.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "expression/graph.hpp"

namespace sysid::gaussian_process {

using Numbers = std::span<double const>;
struct Jet;
using Jets = std::span<Jet const>;

/// One point against many: all of a kernel's work is done on such strips.
struct Strip {
  std::span<double const* const> left;  // [D]: for each input the coordinates of `size` points
  Numbers right;                        // [D]: the one point
  int size = 0;                         // <= strip_size
};
constexpr int strip_size = 256;

/// The unit of a hyper-parameter as powers of three others: of the function's values, of the input that it belongs to, and of one
/// that the kernel brings itself (force, for the oscillator).
struct UnitPowers {
  int output = 0;
  int input = 0;
  int own = 0;
};

/// Every hyper-parameter is positive, and its coordinate is its logarithm.
struct HyperParameterRow {
  std::string_view name;
  bool per_input;  // one for each input, in their order
  UnitPowers unit;
};

/// A stationary Gaussian process in one input as the first state of a linear stochastic equation of `dimension` states:
/// x(t + step) = A x(t) + noise, cov x = P at every t, so cov noise = P - A P A^T.                 Särkkä & Solin 2019,
/// sec. 6.3, 12.3
struct StateSpaceRow {
  int dimension;
  /// P [d x d] and, for each hyper-parameter, its derivative in the hyper-parameter's logarithm; matrices by columns, one after
  /// another.
  void (*stationary)(Numbers parameters, double* covariance, double* derivatives);
  /// A [d x d] over `step` >= 0, and its derivatives likewise; nullptr where they are not wanted.
  void (*transition)(Numbers parameters, double step, double* transition, double* derivatives);
};

struct KernelRow {
  std::string_view name;
  std::span<HyperParameterRow const> hyper_parameters;
  bool one_input = false;  // reads exactly one input; else any number
  /// k(left_i, right) into out [size].
  void (*values)(Strip const&, Numbers parameters, double* out);
  /// gradient [hyper-parameters] += sum over i of weights_i dk(left_i, right)/dlog(parameter); values: those of `values`.
  void (*add_gradient)(Strip const&, Numbers parameters, double const* values, double const* weights, double* gradient);
  /// k(left, right) with its derivatives, from points [D] and hyper-parameters that carry theirs; where two points coincide and the
  /// kernel has a corner, its derivative there is 0.
  Jet (*jet)(Jets left, Jets right, Jets parameters);
  bool differentiable = true;                  // whether functions have a first derivative
  StateSpaceRow const* state_space = nullptr;  // nullptr: has none
  /// The square root of the Fourier transform of the covariance over the differences of its inputs, at angular frequencies [D], as
  /// an expression of the hyper-parameters; the convention is k(0) = (2 pi)^-D times the integral of its square. nullptr: the
  /// kernel is not stationary, or has lines in place of a density.
  NodeId (*spectral_root)(Graph&, std::span<NodeId const> parameters, Numbers frequencies) = nullptr;
  /// Of a kernel of finite rank: one function of the inputs [D] for each hyper-parameter, with a standard normal coefficient each.
  std::vector<NodeId> (*features)(Graph&, std::span<NodeId const> parameters, std::span<NodeId const> inputs) = nullptr;
  std::string_view summary;
};

std::span<KernelRow const> kernels();
/// nullptr when there is none of that name.
KernelRow const* find_kernel(std::string_view name);

/// How many hyper-parameters the kernel has on that many inputs.
int hyper_parameter_count(KernelRow const& row, int inputs);

}  // namespace sysid::gaussian_process
