// A stationary Gaussian process on a box as a finite sum of known functions with independent normal coefficients: what an equation
// in continuous time can hold.
#pragma once
#include <vector>

#include "expression/term.hpp"
#include "gaussian_process/kernel.hpp"

namespace sysid::gaussian_process {

/// Where a basis lies: each [D], half_widths > 0, counts >= 1.
struct Box {
  std::vector<double> centre, half_widths;
  std::vector<int> counts;
};

/// Eigenfunctions of the Laplace operator on the box of centre c and half-widths L, zero at its faces; for j_d = 1 ... count_d, the
/// last input's fastest:
///
///   phi_j(x) = product over d of L_d^(-1/2) sin(w_jd (x_d - c_d + L_d)),   w_jd = pi j_d/(2 L_d)
///
///   k(x, x') = sum over j of S(w_j) phi_j(x) phi_j(x'), nearly                   Solin & Särkkä 2020, eq. 56, 60, 68
///
/// Good where x keeps some length-scales away from the faces and the highest frequencies lie beyond the kernel's.
class Basis {
 public:
  explicit Basis(Box box);

  int size() const { return static_cast<int>(frequencies_.size()); }
  /// w_j of one function, angular frequencies [D].
  std::vector<double> const& frequencies(int function) const { return frequencies_[static_cast<std::size_t>(function)]; }
  /// Sum over j of weights_j phi_j at inputs [D], expressions: one sine and one cosine for each input, the rest are products.
  NodeId sum(Graph& graph, std::span<NodeId const> inputs, std::span<NodeId const> weights) const;

 private:
  Term sum(std::vector<std::vector<Term>> const& sines, std::size_t input, std::span<NodeId const>& weights) const;

  Box box_;
  std::vector<std::vector<double>> frequencies_;
};

/// Whether a kernel can be written as such a sum, or is one by itself.
bool has_expansion(KernelRow const& row);
/// How many functions it takes over the inputs that the kernel reads, `counts` of them along each [D].
int expansion_size(KernelRow const& row, std::vector<int> const& counts);
/// The process at inputs [D] where `coefficients` [expansion_size] are independent and standard normal. box: over the same inputs;
/// parameters: the kernel's, expressions > 0.
NodeId expansion(KernelRow const& row, Graph& graph, std::span<NodeId const> parameters, std::span<NodeId const> inputs,
                 std::span<NodeId const> coefficients, Box const& box);

}  // namespace sysid::gaussian_process
