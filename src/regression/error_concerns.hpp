// Whether the errors of a difference equation are independent: of each other, and of the inputs before them.
#pragma once
#include <Eigen/Core>

#include "regression/column/columns.hpp"
#include "regression/column/concern.hpp"

namespace sysid::regression {

/// n (n + 2) sum r_k^2/(n - k) over lags k = 1 ... of n errors with correlations r_k, as they follow one another: about chi-squared
/// of as many degrees where they are white.                                                                    Ljung and Box 1978
struct Portmanteau {
  double statistic = 0;
  double correlations = 0;  // their sum
};
Portmanteau portmanteau(Eigen::VectorXd const& errors, Eigen::Index lags);

/// errors: row by row; empty where they are rounding, of which nothing is said. runs: of rows that follow one another. any_term:
/// whether one was chosen. coloured: whether the noise has come out as a moving average.
Concerns error_concerns(NoiseOfEquation const& noise, int equation, Eigen::VectorXd const& errors, int runs, bool any_term,
                        bool coloured);

}  // namespace sysid::regression
