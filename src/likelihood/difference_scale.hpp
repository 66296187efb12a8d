// Lengths that coordinates are moved by when derivatives are taken by differences: parts of the widths of their prior, which are
// measured once, at the first need.
#pragma once
#include <mutex>
#include <vector>

namespace sysid {

class Target;

/// Thread-safe. A copy measures again: it may belong to another target.
class DifferenceScale {
 public:
  DifferenceScale() = default;
  DifferenceScale(DifferenceScale const&) {}
  DifferenceScale& operator=(DifferenceScale const&) { return *this; }

  /// [P] half the central 68 % of prior draws of the target that it belongs to, > 0; 1 where they have no width.
  std::vector<double> const& of(Target const& target) const;

 private:
  mutable std::once_flag measured_;
  mutable std::vector<double> scale_;
};

}  // namespace sysid
