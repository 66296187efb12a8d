// What a search maximises: a posterior or a likelihood over the sampler's coordinates, scaled by the widths of the prior.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/system/ledger.hpp"
#include "likelihood/target.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

class Journal;

struct Objective {
  Target const& target;
  ObjectiveKind objective_kind;
  Eigen::VectorXd scale;   // [P] half the central 68 % of the prior draws, > 0
  Eigen::VectorXd centre;  // [P] the middle of these
  Eigen::VectorXd low,
      high;                 // [P] beyond the draws on bounded sides: past here a bound is reached to the last digit; else infinite
  Eigen::VectorXd nearest;  // [P] to one bound alone that is not 0: nearer all coordinates are one number; else -infinity

  int dimension() const { return static_cast<int>(scale.size()); }
  /// The same widths over another target, whose prior is the same.
  Objective over(Target const& other, ObjectiveKind kind) const { return {other, kind, scale, centre, low, high, nearest}; }
  /// The prior's part alone; 0 for `likelihood`.
  std::vector<double> log_prior(ConstLanes theta) const;
  /// -infinity wherever it is not finite.
  std::vector<double> log_density(ConstLanes theta, Ledger& ledger) const;
  /// A step that ends beyond `low` or `high` ends there, or where it began if that was beyond already.
  Eigen::VectorXd clamp(Eigen::VectorXd const& theta, Eigen::VectorXd const& from) const {
    return theta.cwiseMax(low.cwiseMin(from)).cwiseMin(high.cwiseMax(from));
  }
};

/// prior_draws [P x N] give the scales.
Objective make_objective(Target const& target, ObjectiveKind objective_kind, ConstLanes prior_draws);
/// Scales from as many draws as know the prior's widths, which is all that is asked of them; step: theirs, of Purpose::start.
Objective make_objective(Target const& target, ObjectiveKind objective_kind, std::uint64_t seed, std::uint64_t step);

/// The columns of a batch, from vectors.
LaneArray to_lanes(std::vector<Eigen::VectorXd> const& points);
Eigen::VectorXd column(ConstLanes theta, int lane);

/// The log density of the columns in blocks of at most 512 lanes: enough to fill any machine, little enough to hold. `stop` is
/// asked before each; what it leaves out is -infinity.
std::vector<double> log_density_in_blocks(Objective const& objective, ConstLanes theta, Ledger& ledger,
                                          std::function<bool()> const& stop = {}, Journal* journal = nullptr);

}  // namespace sysid
