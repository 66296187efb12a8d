// Which covariances of random states there are: those that are zero whatever the parameters take no state.
#pragma once
#include <utility>
#include <vector>

#include "program/moments/moment_passage.hpp"

namespace sysid {

/// Some of all pairs of states, in no order of the two.
class StatePairs {
 public:
  explicit StatePairs(int states) : rows_(static_cast<std::size_t>(states), std::vector<bool>(static_cast<std::size_t>(states))) {}

  int states() const { return static_cast<int>(rows_.size()); }
  bool operator()(int i, int j) const { return rows_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]; }
  void add(int i, int j) {
    rows_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
        rows_[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = true;
  }
  friend bool operator==(StatePairs const&, StatePairs const&) = default;

 private:
  std::vector<std::vector<bool>> rows_;
};

/// What changes the covariances of random states.
struct CovarianceChanges {
  MomentPassage const& passage;
  std::vector<MomentRow> const& rules;    // of each state: its next value by a map, else its derivative
  std::vector<MomentRow> const& outputs;  // of which samples correct the states
  bool map;
  int first_column;  // of the passage
  bool factored;     // what is stored are factors of the covariance
};

/// Those that differ from zero at some time, where `first` do at the beginning or by what noise adds.
StatePairs covariance_pattern(CovarianceChanges const& changes, StatePairs first);

}  // namespace sysid
