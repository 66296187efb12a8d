// Candidates of one batch: as theta, and as a mixture over declared values sees them.
#pragma once
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "inference/chain/independence.hpp"
#include "likelihood/target.hpp"

namespace sysid::metropolis {

/// Columns theta [P x W] in the coordinates x of a mixture, and log |d x / d theta|, which is added to the log of a density over x
/// to have that over theta.
struct Framed {
  LaneArray x;                    // [P x W]
  std::vector<double> log_slope;  // [W]
};

/// declared: x are the declared values; else theta itself.
Framed framed(Target const& target, bool declared, ConstLanes theta);

class Candidates {
 public:
  /// Places for `width` candidates; mixture: whose coordinates x are, null where none is drawn from one.
  Candidates(Target const& target, Independence const* mixture, int width);

  /// Where walks are written to, [P x W].
  Lanes theta() { return theta_; }
  /// Where column `lane` is written to when it is drawn from, or moved about, the mixture.
  Lanes drawn(int lane) {
    from_mixture_[static_cast<std::size_t>(lane)] = 1;
    return framed_.x;
  }
  /// The same for columns [first, first + count), which alone are seen.
  Lanes drawn(int first, int count) {
    for (int lane = first; lane < first + count; ++lane) from_mixture_[static_cast<std::size_t>(lane)] = 1;
    return framed_.x.view().columns(first, count);
  }
  /// Evaluates all candidates. A draw outside the parameters' support is not simulated: `instead` [P x W] holds columns that can
  /// be, and its density is 0.
  void evaluate(ConstLanes instead, Ledger& ledger);

  // After that:
  ConstLanes theta() const { return theta_; }
  Framed const& framed() const { return framed_; }
  double log_prior(int lane) const { return log_prior_[static_cast<std::size_t>(lane)]; }
  double log_likelihood(int lane) const { return log_likelihood_[static_cast<std::size_t>(lane)]; }
  bool outside(int lane) const { return outside_[static_cast<std::size_t>(lane)] != 0; }

 private:
  void place(ConstLanes instead);

  Target const& target_;
  bool declared_;
  LaneArray theta_;
  Framed framed_;
  std::vector<char> from_mixture_, outside_;
  std::vector<double> log_prior_, log_likelihood_;
};

}  // namespace sysid::metropolis
