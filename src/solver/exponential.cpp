// The exact step of equations that are linear in their states, with inputs that are held or straight lines over the step:
//   x' = A x + b(t),   x(h) = x + X x + h (phi_1 - phi_2) b(0) + h phi_2 b(h),   X = exp(hA) - 1,
//   phi_1(z) = (e^z - 1)/z,  phi_2(z) = (phi_1(z) - 1)/z  at z = hA            Hochbruck & Ostermann 2010, section 2.1
// No matrix is inverted, so A may be singular or defective. All three functions come by scaling and doubling (Moler & Van Loan
// 2003, method 3), with X in place of exp(hA), which would round the slow part of a step to that of 1:
//   X(2z) = 2 X + X^2,   phi_1(2z) = phi_1 + X phi_1/2,   phi_2(2z) = (2 phi_2 + phi_1 + X phi_2)/4
// The matrices read parameters and the sampling step alone, so that they are computed once per parameter vector
// and length of a step.
//
// White noise of intensity Q adds the covariance V = integral of exp(sA) Q exp(sA)' over the step, which comes in the same way:
//   V(2z) = V + (1 + X) V (1 + X)'
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/text/diagnostic.hpp"
#include "solver/exact_moments.hpp"
#include "solver/linear_structure.hpp"
#include "solver/matrix_expressions.hpp"
#include "solver/stages.hpp"

namespace sysid {
namespace {

constexpr int doublings = 30;
constexpr int degree = 15;  // of the series of phi_2; what it leaves out is below rounding where the scaled matrix is below 1
// The size of the scaled matrix is that of a high power of it, so that the units of the states hardly matter: a factor of 1e8
// between entries that multiply to the same rate counts 10.
constexpr double most_scaled = 0.5;
constexpr int power_of_check = 8;

// Of the series of V, which has twice the matrix in place of the matrix: fewer terms, from a smaller matrix.
constexpr int doublings_of_noise = 24;
constexpr int degree_of_noise = 7;
constexpr double most_scaled_of_noise = 1.0 / 64;

/// exp(hA) - 1, and columns of phi_1(hA) and phi_2(hA).
struct Exponential {
  Matrix x, phi_1, phi_2;
  // Where there is noise: all columns of phi_1; the lower triangle of V.
  Matrix whole_phi_1, noise;
};

class Writer {
 public:
  /// noisy: with room for the covariance of a noise.
  explicit Writer(Stages const& stages, bool noisy = false)
      : graph_(stages.graph),
        matrices_(graph_),
        doublings_(noisy ? doublings_of_noise : doublings),
        most_scaled_(noisy ? most_scaled_of_noise : most_scaled),
        states_(stages.states),
        h_(graph_.leaf(LeafKind::step_length)),
        zero_(graph_.constant(0)) {
    if (find_nonlinear(graph_, stages.derivative)) throw InternalError("an exact step of equations that are not linear");
    std::vector<NodeId> const at_rest(states_.size(), zero_);
    begin_ = stages.evaluate(at_rest, Stage::begin);
    end_ = stages.evaluate(at_rest, Stage::end);
    for (int i = 0; i < size(); ++i)
      if (!matrices_.is_zero(begin_[static_cast<std::size_t>(i)]) || !matrices_.is_zero(end_[static_cast<std::size_t>(i)]))
        forced_.push_back(i);
  }

  std::vector<NodeId> next(std::span<NodeId const> derivative) { return next(exponential(jacobian(derivative), false)); }

  ExactMoments moments(std::span<NodeId const> derivative, std::span<NodeId const> intensity) {
    Matrix const a = jacobian(derivative);
    noise_ = intensity;
    Exponential const exact = exponential(a, true);
    ExactMoments result;
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j < size(); ++j) {
        result.transition.push_back(i == j ? graph_.add(exact.x(i, j), graph_.constant(1)) : exact.x(i, j));
        result.integral.push_back(graph_.multiply(h_, exact.whole_phi_1(i, j)));
        result.added.push_back(exact.noise(std::max(i, j), std::min(i, j)));
      }
    result.states = next(exact);
    return result;
  }

 private:
  std::vector<NodeId> next(Exponential const& exact) {
    std::vector<NodeId> result;
    for (int i = 0; i < size(); ++i) {
      NodeId sum = states_[static_cast<std::size_t>(i)];
      for (int j = 0; j < size(); ++j) sum = graph_.add(sum, graph_.multiply(exact.x(i, j), states_[static_cast<std::size_t>(j)]));
      for (int j = 0; j < static_cast<int>(forced_.size()); ++j) sum = graph_.add(sum, forcing(exact, i, j));
      result.push_back(sum);
    }
    return result;
  }

  int size() const { return static_cast<int>(states_.size()); }

  Matrix jacobian(std::span<NodeId const> derivative) {
    Matrix a = matrices_.zeros(size(), size());
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j < size(); ++j)
        a(i, j) = graph_.differentiate(derivative[static_cast<std::size_t>(i)], states_[static_cast<std::size_t>(j)]);
    return a;
  }

  /// What the j-th of the forced states gives to state i.
  NodeId forcing(Exponential const& exact, int i, int j) {
    auto const state = static_cast<std::size_t>(forced_[static_cast<std::size_t>(j)]);
    NodeId const phi_1 = exact.phi_1(i, j), phi_2 = exact.phi_2(i, j);
    if (begin_[state] == end_[state]) return graph_.multiply(graph_.multiply(h_, phi_1), begin_[state]);
    NodeId const early = graph_.multiply(h_, graph_.subtract(phi_1, phi_2)), late = graph_.multiply(h_, phi_2);
    NodeId const from_end = graph_.multiply(late, end_[state]);
    return graph_.add(graph_.multiply(early, begin_[state]), from_end);
  }

  Exponential exponential(Matrix const& a, bool noisy) {
    NodeId const least = graph_.multiply(h_, graph_.constant(std::ldexp(1.0, -doublings_)));
    Matrix const z = matrices_.scaled(least, a);
    Matrix const z2 = matrices_.product(z, z), z3 = matrices_.product(z2, z), z4 = matrices_.product(z2, z2);
    // sum z^k/(k + 2)!, four terms at a time (Paterson & Stockmeyer 1973).
    Matrix phi_2 = matrices_.zeros(size(), size());
    for (int first = degree - 3; first >= 0; first -= 4) {
      Matrix terms = matrices_.add_scaled(matrices_.scaled(coefficient(first + 3), z3), coefficient(first + 2), z2);
      terms = matrices_.add_to_diagonal(matrices_.add_scaled(std::move(terms), coefficient(first + 1), z), coefficient(first));
      phi_2 = matrices_.add_product(std::move(terms), z4, phi_2);
    }
    Matrix phi_1 = matrices_.add_to_diagonal(matrices_.product(z, phi_2), 1);
    Matrix x = matrices_.product(z, phi_1);
    Matrix whole = noisy ? phi_1 : matrices_.zeros(0, 0), noise = noisy ? least_noise(z, least) : matrices_.zeros(0, 0);
    phi_1 = Matrices::columns_of(phi_1, forced_, zero_);
    phi_2 = Matrices::columns_of(phi_2, forced_, zero_);
    // After i doublings 2^i phi_1 and 4^i phi_2: powers of two are exact, and the matrix X need not be multiplied by them.
    for (int i = 0; i < doublings_; ++i) {
      phi_2 = matrices_.add_product(matrices_.add_scaled(matrices_.scaled(2.0, phi_2), std::ldexp(1.0, i), phi_1), x, phi_2);
      phi_1 = matrices_.add_product(matrices_.scaled(2.0, phi_1), x, phi_1);
      if (noisy) {
        whole = matrices_.add_product(matrices_.scaled(2.0, whole), x, whole);
        noise = doubled(noise, x);
      }
      x = matrices_.add_product(matrices_.scaled(2.0, x), x, x);
    }
    return {failing_beyond_reach(std::move(x), matrices_.product(z4, z4), a), matrices_.scaled(std::ldexp(1.0, -doublings_), phi_1),
            matrices_.scaled(std::ldexp(1.0, -2 * doublings_), phi_2), matrices_.scaled(std::ldexp(1.0, -doublings_), whole),
            std::move(noise)};
  }

  /// V of the smallest step: step * sum L^k(Q)/(k + 1)!, L(Q) = Z Q + Q Z'. Whole.
  Matrix least_noise(Matrix const& z, NodeId step) {
    Matrix power = matrices_.zeros(size(), size());
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j < size(); ++j) power(i, j) = noise_[static_cast<std::size_t>(i * size() + j)];
    Matrix sum = power;
    double factorial = 1;
    for (int k = 1; k <= degree_of_noise; ++k) {
      Matrix const half = matrices_.product(z, power);
      for (int i = 0; i < size(); ++i)
        for (int j = 0; j <= i; ++j) power(i, j) = power(j, i) = graph_.add(half(i, j), half(j, i));
      factorial *= k + 1;
      sum = matrices_.add_scaled(std::move(sum), 1 / factorial, power);
    }
    return matrices_.scaled(step, sum);
  }

  /// V + (1 + X) V (1 + X)'
  Matrix doubled(Matrix const& v, Matrix const& x) {
    Matrix const moved = matrices_.add_product(v, x, v);  // (1 + X) V
    Matrix result = v;
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j <= i; ++j) {
        NodeId entry = graph_.add(v(i, j), moved(i, j));
        for (int k = 0; k < size(); ++k) matrices_.add_product(entry, moved(i, k), x(j, k));
        result(i, j) = result(j, i) = entry;
      }
    return result;
  }

  /// 1/(k + 2)!, whose last digit a gamma function would not always meet.
  static double coefficient(int k) {
    double factorial = 1;
    for (int i = 2; i <= k + 2; ++i) factorial *= i;
    return 1 / factorial;
  }

  /// NaN where the scaled matrix is too large for the series. An entry that lies on no cycle of A plays no part in how fast powers
  /// grow: how large it is is a matter of units, as of the derivatives that tangents add below the diagonal.
  Matrix failing_beyond_reach(Matrix x, Matrix const& power, Matrix const& a) {
    std::vector<std::vector<bool>> const reaches = reachable(a);
    std::set<NodeId> norms;
    for (int i = 0; i < size(); ++i) {
      NodeId norm = zero_;
      for (int j = 0; j < size(); ++j)
        if (reaches[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] &&
            reaches[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)])
          norm = graph_.add(norm, graph_.unary(Operation::absolute, power(i, j)));
      if (!matrices_.is_zero(norm)) norms.insert(norm);
    }
    NodeId largest = zero_;
    for (NodeId const norm : norms) largest = largest == zero_ ? norm : graph_.binary(Operation::maximum, largest, norm);
    NodeId const within = graph_.binary(Operation::less_equal, largest, graph_.constant(std::pow(most_scaled_, power_of_check)));
    NodeId const nothing = graph_.select(within, zero_, graph_.constant(std::numeric_limits<double>::quiet_NaN()));
    for (int i = 0; i < size(); ++i)
      for (int j = 0; j < size(); ++j)
        if (!matrices_.is_zero(x(i, j))) x(i, j) = graph_.add(x(i, j), nothing);
    return x;
  }

  /// Whether state i depends on state j, directly or through others.
  std::vector<std::vector<bool>> reachable(Matrix const& a) const {
    auto const n = static_cast<std::size_t>(size());
    std::vector<std::vector<bool>> result(n, std::vector<bool>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) result[i][j] = !matrices_.is_zero(a(static_cast<int>(i), static_cast<int>(j)));
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n && result[i][k]; ++j) result[i][j] = result[i][j] || result[k][j];
    return result;
  }

  Graph& graph_;
  Matrices matrices_;
  int doublings_;
  double most_scaled_;
  std::vector<NodeId> states_;
  NodeId h_, zero_;
  std::vector<NodeId> begin_, end_;  // the derivative at rest, at the ends of the step: b
  std::vector<int> forced_;          // where that is not zero
  std::span<NodeId const> noise_;    // Q [n x n]
};

}  // namespace

std::vector<NodeId> exponential_step(Stages const& stages) { return Writer(stages).next(stages.derivative); }

ExactMoments exact_moments(Stages const& stages, std::span<NodeId const> intensity) {
  return Writer(stages, true).moments(stages.derivative, intensity);
}

}  // namespace sysid
