// The damping of Gauss-Newton steps (Marquardt 1963).
#pragma once
#include <algorithm>

namespace sysid {

/// Relative to the squared lengths of the columns: a tenth of it after a step that gained, ten times as much after one that lost.
class Damping {
 public:
  static constexpr double first = 1e-3;

  double value() const { return value_; }
  void less() { value_ = std::max(value_ / 10, least); }
  void more() { value_ = std::max(10 * value_, first); }
  /// Steps so short have lost that a shorter one gains nothing that counts.
  bool exhausted() const { return value_ > most; }

 private:
  static constexpr double most = 1e10, least = 1e-12;
  double value_ = first;
};

}  // namespace sysid
