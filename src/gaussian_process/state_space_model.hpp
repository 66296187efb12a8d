// A sum of kernels in one input as one linear stochastic equation: the blocks of its terms side by side.
#pragma once
#include <vector>

#include "gaussian_process/covariance.hpp"

namespace sysid::gaussian_process {

/// As many states as one equation may have; the filters are written out for every number up to it.
constexpr int most_states = 8;

/// Whether the covariance is a sum of kernels that have a state-space form, all reading one and the same input.
bool has_state_space(Covariance const& covariance);

/// f = sum of the first states of all blocks;  x(t + step) = A x(t) + noise,  cov x = P. Matrices by columns.
class StateSpaceModel {
 public:
  /// `has_state_space` of the covariance; refers to it.
  StateSpaceModel(Covariance const& covariance, Numbers parameters);

  int dimension() const { return dimension_; }
  int parameter_count() const { return parameter_count_; }
  /// The column of the inputs that is time.
  int column() const { return column_; }
  /// P [d x d].
  double const* stationary() const { return stationary_.data(); }
  /// 1 for the states that f is the sum of, else 0 [d].
  double const* measured() const { return measured_.data(); }

  /// A over `step`; what it points to is valid until the next call. With derivatives, `add_transition_gradient` may follow.
  double const* transition(double step, bool with_derivatives);
  /// gradient [P] += sum over the elements of weight [d x d] times dA/dlog(parameter), A the last transition.
  void add_transition_gradient(double const* weight, double* gradient) const;
  /// The same of the stationary covariance.
  void add_stationary_gradient(double const* weight, double* gradient) const;

 private:
  struct Block {
    StateSpaceRow const* row;
    Numbers parameters;
    int first_state, first_parameter;
    std::vector<double> transition, transition_derivatives, stationary_derivatives;
  };
  void add_gradient(double const* weight, std::vector<double> Block::*derivatives, double* gradient) const;

  int dimension_ = 0, parameter_count_ = 0, column_ = 0;
  std::vector<Block> blocks_;
  std::vector<double> stationary_, measured_, transition_;
};

}  // namespace sysid::gaussian_process
