// Proposals of a population, by number: each depends on its number and the last population alone, never on who asks or how many at
// once.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "inference/abc/population.hpp"
#include "inference/abc/walk.hpp"
#include "likelihood/selection/selection_target.hpp"

namespace sysid::abc {

/// Proposals with consecutive numbers, sorted by model. Of model m: columns 0, 1, ... of x[m] (coordinates of the walk) and
/// theta[m].
struct Proposed {
  std::vector<int> model, column;              // by proposal
  std::vector<LaneArray> x, theta;             // by model
  std::vector<std::vector<double>> log_prior;  // by model and column; -infinity outside the prior's support
};

class Proposals {
 public:
  /// last: number 0 stands for the prior. Its particles must outlive this.
  Proposals(SelectionTarget const& candidates, Plan const& plan, Walk const& walk, std::uint64_t seed, Population const& last);

  /// Proposals first, first + 1, ..., `count` of them, for population last.number + 1.
  Proposed make(std::uint64_t first, int count) const;

  /// The probability with which a proposal is of this model.
  double model_probability(int model) const { return probability_[static_cast<std::size_t>(model)]; }
  /// Logarithms of the weights, not normalised, of accepted particles at x [D x W] of a model with these log priors:
  ///
  ///   w = p(m) p(theta | m) / (q(m) sum_(j in m) w_j / W_m K_m(theta | theta_j))
  ///
  /// The sum runs over particles of the same model, its weights normalised within the model. In print (Algorithm 1, line 18) it
  /// runs over all particles, and the factor p(m)/q(m) is left out.
  /// stop is asked now and then; once it says yes the rest is left as it is.
  std::vector<double> log_weights(int model, ConstLanes x, std::span<double const> log_prior,
                                  std::function<bool()> const& stop = {}) const;

 private:
  void draw_from_prior(std::uint64_t first, Proposed& proposed) const;
  /// streams: by model and column, behind the number that drew the model.
  void move_particles(std::vector<std::vector<Stream>>& streams, Proposed& proposed) const;
  int draw_model(Stream& stream) const;
  void rate(Proposed& proposed) const;

  SelectionTarget const& candidates_;
  Walk const& walk_;
  std::uint64_t seed_;
  Population const& last_;
  std::vector<double> probability_;              // of each model to be proposed
  std::vector<LaneArray> centres_;               // by model
  std::vector<std::vector<double>> within_;      // weights within the model
  std::vector<std::vector<double>> cumulative_;  // of them
  std::vector<std::unique_ptr<Kernel>> kernels_;
};

/// q(m): under the prior among the models that have particles; or by the last population's probabilities and a kernel that stays
/// with probability `stay` and goes to each other living model alike.
std::vector<double> model_proposal(SelectionTarget const& candidates, Plan const& plan, Population const& last);

}  // namespace sysid::abc
