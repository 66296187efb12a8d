// Whether the errors of a difference equation are independent: of each other, and of the inputs before them.
#pragma once
#include <Eigen/Core>

#include "regression/column/columns.hpp"
#include "regression/column/concern.hpp"

namespace sysid::regression {

/// errors: row by row; empty where they are rounding, of which nothing is said. runs: of rows that follow one another. any_term:
/// whether one was chosen. coloured: whether the noise has come out as a moving average.
Concerns error_concerns(NoiseOfEquation const& noise, int equation, Eigen::VectorXd const& errors, int runs, bool any_term,
                        bool coloured);

}  // namespace sysid::regression
