// The damping of Gauss-Newton steps (Marquardt 1963).
#pragma once
#include <algorithm>

namespace sysid {

/// Relative to the squared lengths of the columns: a tenth of it after a step that gained. After steps that lost ten times as much,
/// then a hundred times that, and so on: the next step is a little shorter, but what is far too long is soon short.
class Damping {
 public:
  static constexpr double first = 1e-3;

  double value() const { return value_; }
  void less() {
    value_ = std::max(value_ / 10, least);
    factor_ = 10;
  }
  void more() {
    value_ *= factor_;
    factor_ *= 10;
  }
  /// Steps so short have lost that a shorter one gains nothing that counts.
  bool exhausted() const { return value_ > most; }

 private:
  static constexpr double most = 1e10, least = 1e-12;
  double value_ = first, factor_ = 10;
};

}  // namespace sysid
