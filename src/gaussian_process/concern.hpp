// What stands between observations and a Gaussian process that says something of them, as values: kind, place, number, and a
// clause. Whoever reports it finds the user's words.
#pragma once
#include <string>
#include <vector>

#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

struct Concern {
  enum class Kind {
    // there is no result. Up to not_finite: `fatal` goes by this order
    not_positive_definite,  // the covariance of the observations, at every start
    dependent_columns,      // flat coefficients of the mean that say the same
    not_finite,             // no start has a finite density
    // the result stands, but look
    duplicate_inputs,  // equal inputs and no noise; value: how many observations repeat an input
    at_bound,          // parameter: one that ended at a bound of its range; value: the bound
    jitter,            // value: what was added to the diagonal, relative to its mean
    no_convergence,    // value: evaluations
    restarts_differ,   // value: by how much the second best of several optima falls short, in log density
    far_outside,       // column: an input beyond the observations' range; value: how far, in widths of that range; infinite where
                       // all observations are at one place
  };

  Kind kind = Kind::not_finite;
  int parameter = -1;
  int column = -1;
  double value = 0;
  std::string clause = {};  // one plain sentence, lower case, no full stop
};

using Concerns = std::vector<Concern>;

bool fatal(Concern::Kind kind);

/// Observations whose inputs, in the columns that are read, are equal to those of another: each repetition counts once.
int repeated_inputs(Eigen::MatrixXd const& inputs, std::vector<int> const& columns);

/// duplicate_inputs where there are any: to be asked when there is no noise, which alone lets two values stand at one input.
Concerns duplicates_without_noise(Eigen::MatrixXd const& inputs, std::vector<int> const& columns);

/// far_outside for each of the columns in which a place lies beyond the observations by more than a tenth of their range; value:
/// the farthest. What a process says there comes from its mean and its kernel, not from observations.
Concerns places_outside(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& places, std::vector<int> const& columns);

}  // namespace sysid::gaussian_process
