// States that chains have been in during burn-in.
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid::metropolis {

/// Of iterations at equal intervals, which double when there are too many states.
class StateArchive {
 public:
  StateArchive() = default;
  explicit StateArchive(int dimension) : dimension_(static_cast<std::size_t>(dimension)) {}

  /// Column `chain` of theta [P x W] at an iteration. Those of one iteration follow each other.
  void add(ConstLanes theta, int chain, std::uint64_t iteration);
  /// Once all states of an iteration are there.
  void thin();

  std::size_t size() const { return iterations_.size(); }
  /// States before the last two thirds, in which chains may still have been on their way.
  std::size_t early() const { return size() / 3; }
  /// At most `most` of those from place `first` on, in their order: of whole iterations, so of all chains alike. [P x n]
  LaneArray picked(std::size_t first, std::size_t most) const;

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch where it is not of dimension P.
  static StateArchive restore(nlohmann::json const& stored, int dimension);

 private:
  std::size_t dimension_ = 0;
  std::vector<double> states_;             // P numbers each
  std::vector<std::uint64_t> iterations_;  // of each state
  std::uint64_t interval_ = 1;
};

}  // namespace sysid::metropolis
