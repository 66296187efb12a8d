// The weak form's test function: a bump that vanishes with its derivatives at the ends of its window.
#pragma once
#include <vector>

namespace sysid::regression {

/// phi(s) = C (1 - s^2)^p on -1 <= s <= 1, of integral 1 over s; derivatives of order below p vanish at both ends.
class TestFunction {
 public:
  /// p >= 1.
  explicit TestFunction(int p);
  int p() const { return p_; }
  /// d^order phi / ds^order at s in [-1, 1]; order < p.
  double derivative(int order, double s) const;
  /// At s = j / half for j = -half..half.
  std::vector<double> samples(int order, int half) const;

 private:
  int p_;
  double scale_;
  std::vector<std::vector<double>> polynomial_;  // [order]: phi^(order) = C Q(s) (1 - s^2)^(p - order), Q by rising powers
};

}  // namespace sysid::regression
