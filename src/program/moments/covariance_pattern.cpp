// A set that grows until nothing comes in.
#include "program/moments/covariance_pattern.hpp"

namespace sysid {
namespace {

class CovarianceGrowth {
 public:
  CovarianceGrowth(CovarianceChanges const& changes, StatePairs first)
      : changes_(changes), states_(first.states()), some_(std::move(first)) {}

  StatePairs run() {
    while (std::exchange(grown_, false)) {
      between_samples();
      for (MomentRow const& output : changes_.outputs)
        if (changes_.passage.by_points(output)) at_samples_by_points(output);
      if (changes_.factored) in_factors();
    }
    return std::move(some_);
  }

 private:
  void mark(int i, int j, bool there) {
    if (!there || some_(i, j)) return;
    some_.add(i, j);
    grown_ = true;
  }

  /// Whether what a row gives varies together with state j.
  bool varies_with(MomentRow const& row, int j) const {
    for (int k = 0; k < states_; ++k)
      if (changes_.passage.moves(row, k) && some_(k, j)) return true;
    return false;
  }

  bool vary_together(MomentRow const& a, MomentRow const& b) const {
    for (int k = 0; k < states_; ++k)
      if (changes_.passage.moves(b, k) && varies_with(a, k)) return true;
    return false;
  }

  void between_samples() {
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) {
        if (some_(i, j)) continue;
        MomentRow const &of_i = changes_.rules[static_cast<std::size_t>(i)], &of_j = changes_.rules[static_cast<std::size_t>(j)];
        mark(i, j, changes_.map ? vary_together(of_i, of_j) : varies_with(of_i, j) || varies_with(of_j, i));
        for (MomentRow const& output : changes_.outputs) mark(i, j, varies_with(output, i) && varies_with(output, j));
      }
  }

  void at_samples_by_points(MomentRow const& output) {
    std::vector<bool> const corrected = corrected_by_points(output, some_);
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j <= i; ++j) mark(i, j, corrected[static_cast<std::size_t>(i)] && corrected[static_cast<std::size_t>(j)]);
  }

  /// Of which states a sample corrects the means, by points along the columns of the Cholesky factor, whose entries are more than
  /// those of the covariance.
  std::vector<bool> corrected_by_points(MomentRow const& output, StatePairs some) const {
    auto const state = [&](int k) { return (changes_.first_column + k) % states_; };
    for (int k = 0; k < states_; ++k)
      for (int i = k + 1; i < states_; ++i)
        for (int j = k + 1; j < states_; ++j)
          if (some(state(i), state(k)) && some(state(j), state(k))) some.add(state(i), state(j));
    std::vector<bool> corrected(static_cast<std::size_t>(states_));
    for (int p = 0; p < states_; ++p) {
      bool bends = false;
      for (int k = p; k < states_; ++k) bends = bends || (some(state(k), state(p)) && changes_.passage.moves(output, state(k)));
      for (int i = p; i < states_; ++i)
        if (bends && some(state(i), state(p))) corrected[static_cast<std::size_t>(state(i))] = true;
    }
    return corrected;
  }

  /// What an elimination from the last state on fills.
  void in_factors() {
    for (int k = states_ - 1; k >= 0; --k)
      for (int i = 0; i < k; ++i)
        for (int j = 0; j <= i; ++j) mark(i, j, some_(i, k) && some_(j, k));
  }

  CovarianceChanges const& changes_;
  int states_;
  StatePairs some_;
  bool grown_ = true;
};

}  // namespace

StatePairs covariance_pattern(CovarianceChanges const& changes, StatePairs first) {
  return CovarianceGrowth(changes, std::move(first)).run();
}

}  // namespace sysid
