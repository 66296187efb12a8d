// The coefficients of an embedded Runge-Kutta method; program/embedded.hpp writes its step with step control.
#pragma once
#include <vector>

namespace sysid {

/// Coefficients of a method: stage i is evaluated at c_i with states y + h sum_j a_ij k_j; the step is y + h sum b_i k_i, its error
/// estimate h sum e_i k_i.
struct EmbeddedMethod {
  int order;  // of the step; the estimate, of the solution of order `order - 1`, is of size h^order
  std::vector<double> c;
  std::vector<std::vector<double>> a;
  std::vector<double> b, e;
};

}  // namespace sysid
