// The heavy-tailed mixture from which an evidence is estimated: normal and Student's t distributions fitted to draws of a
// posterior.
#pragma once
#include <functional>
#include <vector>

#include "inference/evidence/component.hpp"

namespace sysid::marginal {

/// q(u) = sum over k of  normal_k N_k(u) + student_k t_k(u),  both of a place and shape.
class Mixture {
 public:
  struct Part {
    Component shape;
    double normal = 0, student = 0;  // shares; those of all parts sum to 1
    bool fixed = false;              // a fit changes its shares alone
  };

  Mixture() = default;
  explicit Mixture(std::vector<Part> parts) : parts_(std::move(parts)) {}

  bool empty() const { return parts_.empty(); }
  std::vector<Part> const& parts() const { return parts_; }
  /// log shares [2 K]: of N_1, t_1, N_2, ...; -infinity where a share is 0.
  std::vector<double> log_shares() const;
  /// log densities [2 K x W], without shares, of the columns of theta.
  LaneArray log_terms(ConstLanes theta) const;
  /// Of all together, from the above. [W]
  std::vector<double> log_density(LaneArray const& log_terms) const;
  /// Writes a draw into a column.
  void draw(StreamKey key, Lanes to, int lane) const;

 private:
  std::vector<Part> parts_;
};

/// Of 1, 2, 4, ... components that are free, beside those of `modes` whose places and shapes stay, the number that gives the last
/// third of the draws the highest density when fitted to those before, by expectation maximisation; then fitted to all. Each
/// component keeps some of its share for its Student's t, and one twice as wide as all draws together a share of its own.
///                                                        Dempster, Laird and Rubin 1977; Peel and McLachlan 2000 (Student's t)
///
/// draws [P x n]: in the order of their chains, chain after chain; those of one chain should be spread over the columns, not next
/// to each other. Empty where there are neither modes nor enough draws.
Mixture fit_mixture(std::vector<Component> const& modes, ConstLanes draws, std::uint64_t seed, std::function<bool()> const& stop);

}  // namespace sysid::marginal
