// The regularised incomplete beta function from operations: it has three arguments, a primitive has two, and with constant
// arguments it folds to a number.
#include "function/primitive.hpp"

namespace sysid {
namespace {

// Terms of the continued fraction: it converges in O(sqrt(max(a, b))) of them; 120 give 1e-12 for a, b up to 1000.
constexpr int terms = 120;

}  // namespace

/// I_x(a, b) for 0 <= x <= 1, a, b > 0, by the continued fraction
///
///   I_x(a, b) = x^a (1-x)^b / (a B(a, b)) * 1/(1 + d_1/(1 + d_2/(1 + ...)))
///   d_2m+1 = -(a+m)(a+b+m) x / ((a+2m)(a+2m+1)),   d_2m = m (b-m) x / ((a+2m-1)(a+2m))                     DLMF 8.17.22, 8.17.23
///
/// evaluated from its end, where x < (a+1)/(a+b+2); elsewhere as 1 - I_{1-x}(b, a), DLMF 8.17.4.
Term incomplete_beta(Term a, Term b, Term x) {
  Term const direct = less(x, (a + 1.0) / (a + b + 2.0));
  Term const p = select(direct, a, b), q = select(direct, b, a), z = select(direct, x, 1.0 - x);
  Term fraction(*a.graph, 1.0);
  for (int i = terms; i >= 1; --i) {
    double const m = i / 2;
    Term const d = i % 2 == 1 ? -((p + m) * (p + q + m) * z / ((p + 2 * m) * (p + (2 * m + 1))))
                              : m * (q - m) * z / ((p + (2 * m - 1)) * (p + 2 * m));
    fraction = 1.0 + d / fraction;
  }
  Term const front = exp(p * log(z) + q * log1p(-z) + lgamma(p + q) - lgamma(p) - lgamma(q)) / p;
  Term const value = front / fraction;
  return select(direct, value, 1.0 - value);
}

}  // namespace sysid
