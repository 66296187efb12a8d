// Derivatives of the bump as a polynomial times what is left of the bump: no cancellation near its ends.
#include "regression/weak/test_function.hpp"

namespace sysid::regression {

TestFunction::TestFunction(int p) : p_(p) {
  // integral over [-1, 1]: I_0 = 2, I_p = I_(p-1) 2 p / (2 p + 1).
  double integral = 2;
  for (int k = 1; k <= p; ++k) integral *= 2.0 * k / (2.0 * k + 1);
  scale_ = 1 / integral;
  polynomial_.push_back({1.0});
  // (Q u^n)' = (Q' u - 2 n s Q) u^(n-1) with u = 1 - s^2
  for (int order = 0; order + 1 < p; ++order) {
    std::vector<double> const& q = polynomial_.back();
    std::vector<double> next(q.size() + 1, 0.0);
    for (std::size_t k = 0; k < q.size(); ++k) {
      double const power = static_cast<double>(k);
      if (k > 0) next[k - 1] += power * q[k];
      next[k + 1] -= (power + 2 * (p - order)) * q[k];
    }
    polynomial_.push_back(std::move(next));
  }
}

double TestFunction::derivative(int order, double s) const {
  std::vector<double> const& q = polynomial_[static_cast<std::size_t>(order)];
  double value = 0;
  for (std::size_t k = q.size(); k-- > 0;) value = value * s + q[k];
  double const u = 1 - s * s;
  for (int k = 0; k < p_ - order; ++k) value *= u;
  return scale_ * value;
}

std::vector<double> TestFunction::samples(int order, int half) const {
  std::vector<double> values;
  for (int j = -half; j <= half; ++j) values.push_back(derivative(order, static_cast<double>(j) / half));
  return values;
}

}  // namespace sysid::regression
