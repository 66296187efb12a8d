// A batch of proposals and what became of each: simulated where the prior allows it, within the threshold or not, or failed.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/abc/proposals.hpp"

namespace sysid::abc {

class Batch {
 public:
  /// Simulates proposals first, first + 1, ..., `count` of them. Throws Interrupted: nothing of the batch is to be kept then.
  Batch(SelectionTarget const& candidates, Proposals const& proposals, std::uint64_t first, int count, double threshold);

  /// Where a simulation went wrong, in the user's words, and when [s].
  using Place = std::pair<std::string, double>;
  /// Adds those of its proposals [from, to), in their order, until there are `most` and before the one that is the `wanted`-th
  /// within the threshold, which is counted down. Throws Interrupted.
  void find_failed_places(std::size_t from, std::size_t to, int& wanted, std::size_t most, std::vector<Place>& found) const;

  std::size_t size() const { return proposed_.model.size(); }
  std::size_t model(std::size_t i) const { return static_cast<std::size_t>(proposed_.model[i]); }
  /// Not where it lies outside the prior's support.
  bool is_simulated(std::size_t i) const { return lane(i) >= 0; }
  /// Of one that is simulated.
  Simulated ending(std::size_t i) const { return ending_[model(i)][static_cast<std::size_t>(lane(i))]; }
  /// Adds one that is within the threshold.
  void keep(std::size_t i, Particles& particles) const;
  /// Adds a failure to the ledger, traced to its place or, with null, counted only.
  void note_failure(std::size_t i, Place const* place, Ledger& ledger) const;

 private:
  /// Of a proposal among those of its model that are simulated; -1: it is not.
  int lane(std::size_t i) const { return lanes_[model(i)][static_cast<std::size_t>(proposed_.column[i])]; }
  ConstLanes theta(std::size_t i) const { return theta_[model(i)].view().columns(lane(i), 1); }
  void sort_out(std::size_t model);

  SelectionTarget const& candidates_;
  Proposed proposed_;
  // By model, of what is simulated.
  std::vector<std::vector<int>> lanes_;  // by its column
  std::vector<LaneArray> theta_;
  std::vector<std::vector<double>> distance_;
  std::vector<std::vector<Simulated>> ending_;
};

}  // namespace sysid::abc
