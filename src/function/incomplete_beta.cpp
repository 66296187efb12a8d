// The regularised incomplete beta function from operations: it has three arguments, a primitive has two, and with constant
// arguments it folds to a number.
#include <algorithm>
#include <cmath>

#include "function/primitive.hpp"

namespace sysid {
namespace {

/// Terms that give a relative error below 1e-13, found by comparison with 6000 terms for a, b from 0.01 to 3000; arguments that are
/// not yet numbers get as many as 165 needs, and lose digits slowly above that.
int terms(Graph const& graph, Term a, Term b) {
  std::optional<double> const first = graph.constant_value(a.id), second = graph.constant_value(b.id);
  double const largest = first && second ? std::max(*first, *second) : 165;
  return largest < 1e5 ? static_cast<int>(30 + 7 * std::sqrt(largest)) : 2250;
}

}  // namespace

/// I_x(a, b) for 0 <= x <= 1, a, b > 0, by the continued fraction
///
///   I_x(a, b) = x^a (1-x)^b / (a B(a, b)) * 1/(1 + d_1/(1 + d_2/(1 + ...)))
///   d_2m+1 = -(a+m)(a+b+m) x / ((a+2m)(a+2m+1)),   d_2m = m (b-m) x / ((a+2m-1)(a+2m))          DLMF 8.17.22, 8.17.23
///
/// evaluated from its end, where x < (a+1)/(a+b+2); elsewhere as 1 - I_{1-x}(b, a), DLMF 8.17.4.
IncompleteBeta incomplete_beta(Term a, Term b, Term x) {
  Term const whole = a + b + 2.0, direct = less(x, (a + 1.0) / whole);
  Term const p = select(direct, a, b), q = select(direct, b, a), z = select(direct, x, 1.0 - x);
  Term fraction(*a.graph, 1.0);
  for (int i = terms(*a.graph, a, b); i >= 1; --i) {
    double const m = i / 2;
    auto const odd = [&] {
      Term const last = p + (2 * m + 1), below = (p + 2 * m) * last, sum = p + q + m;
      return -((p + m) * sum * z / below);
    };
    auto const even = [&] {
      Term const last = p + 2 * m, below = (p + (2 * m - 1)) * last;
      return m * (q - m) * z / below;
    };
    fraction = 1.0 + (i % 2 == 1 ? odd() : even()) / fraction;
  }
  Term const far = log1p(-x), near = log(x), log_z = select(direct, near, far), log_rest = select(direct, far, near);
  Term const of_q = lgamma(q), of_p = lgamma(p), of_both = lgamma(p + q), rest = q * log_rest;
  Term const value = exp(p * log_z + rest + of_both - of_p - of_q) / p / fraction;
  return {select(direct, value, 1.0 - value), select(direct, 1.0 - value, value)};
}

}  // namespace sysid
