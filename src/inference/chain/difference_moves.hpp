// Differential-evolution moves: along differences of states that chains of the same density have visited.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "inference/chain/metropolis.hpp"

namespace sysid::metropolis {

/// x' = x + g (a - b) + e, with a and b two different states of an archive; g is learnt, and 1 once in ten moves, which leads from
/// mode to mode where the archive has states of both; e is normal, a thousandth of the archive's widths. Symmetric in x and x' for
/// an archive that stays as it is, which it does after burn-in. The moves have the shape of the density, curved or in several
/// parts, without a covariance.                                                          ter Braak and Vrugt 2008 (DE-MC(Z))
class DifferenceMoves {
 public:
  DifferenceMoves() = default;
  /// first [P x M], M >= 2: what the archive holds before chains have filled it.
  explicit DifferenceMoves(ConstLanes first);

  /// Writes a move from column `chain` of `from` into column `lane` of `to`; returns whether g is 1.
  bool propose(StreamKey key, ConstLanes from, int chain, Lanes to, int lane) const;

  /// After an iteration of burn-in: chains [first, first + count) of `state` made the moves [first, first + count) of `info`
  /// (`small`: g was 1). g tends to an acceptance of 0.234; every few iterations the states enter the archive, where they replace
  /// the oldest.
  void learn(State const& state, Info const& info, int first, int count);

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch where it is not of dimension P.
  static DifferenceMoves restore(nlohmann::json const& stored, int dimension);

 private:
  void measure_widths();

  LaneArray archive_;           // [P x M]
  std::vector<double> widths_;  // [P]
  double log_scale_ = 0, scale_ = 1;
  std::uint64_t iteration_ = 0;
  int next_ = 0;  // column of the archive to replace
};

}  // namespace sysid::metropolis
