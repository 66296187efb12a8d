// Recursions run by run; Gauss-Newton steps, halved until they lower the squares and keep the noise invertible.
#include "regression/column/moving_average.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::regression {
namespace {

constexpr int most_rounds = 100, most_halvings = 30;
constexpr double enough = 1e-9;  // in twice the log likelihood, that a round gains
constexpr double shift = 1e-6;
constexpr double nearest_zero = 0.995;  // a zero of C nearer to the circle than this forgets too slowly to be told from it
constexpr double moved_out = 0.97;

/// Whether all zeros of C lie outside the unit circle: by the step-down recursion of Levinson, whose numbers are then below 1.
bool is_invertible(std::vector<double> c) {
  for (std::size_t q = c.size(); q > 0; --q) {
    double const reflection = c[q - 1];
    if (!(std::abs(reflection) < nearest_zero)) return false;
    std::vector<double> lower(q - 1);
    for (std::size_t k = 0; k + 1 < q; ++k) lower[k] = (c[k] - reflection * c[q - 2 - k]) / (1 - reflection * reflection);
    c = std::move(lower);
  }
  return true;
}

/// v divided by C in one run, from e = 0 before it.
Eigen::MatrixXd divided_by(std::vector<double> const& c, Eigen::MatrixXd v) {
  auto const order = static_cast<Eigen::Index>(c.size());
  for (Eigen::Index i = 1; i < v.rows(); ++i) {
    Eigen::Index const terms = std::min(order, i);
    for (Eigen::Index column = 0; column < v.cols(); ++column) {
      double* const e = v.data() + column * v.rows() + i;
      double left = *e;
      for (Eigen::Index k = 1; k <= terms; ++k) left -= c[static_cast<std::size_t>(k - 1)] * e[-k];
      *e = left;
    }
  }
  return v;
}

/// What errors of 1 before a run, the last one first, do to its e. [count x q]
Eigen::MatrixXd responses(std::vector<double> const& c, Eigen::Index count) {
  auto const order = static_cast<Eigen::Index>(c.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(count, order);
  for (Eigen::Index j = 0; j < order; ++j)  // e_-1-j
    for (Eigen::Index i = 0; i < count && i + j < order; ++i) out(i, j) = -c[static_cast<std::size_t>(i + j)];
  return divided_by(c, std::move(out));
}

/// R, and the decomposition of R above I.
struct Start {
  Eigen::MatrixXd responses;
  OrthogonalTriangular decomposed;
};

/// One for each length of a run.
class Starts {
 public:
  explicit Starts(std::vector<double> const& c) : c_(c) {}
  Start const& operator()(Eigen::Index count) {
    auto const known = of_.find(count);
    if (known != of_.end()) return known->second;
    auto const order = static_cast<Eigen::Index>(c_.size());
    Eigen::MatrixXd both(count + order, order);
    both << responses(c_, count), Eigen::MatrixXd::Identity(order, order);
    return of_.emplace(count, Start{both.topRows(count), OrthogonalTriangular(both)}).first->second;
  }

 private:
  std::vector<double> c_;
  std::map<Eigen::Index, Start> of_;
};

/// Rows above zeros, one for each error before a run.
Eigen::MatrixXd with_zeros(Eigen::MatrixXd const& rows, Eigen::Index order) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.rows() + order, rows.cols());
  out.topRows(rows.rows()) = rows;
  return out;
}

MovingAverage::Errors errors_of(MovingAverage const& average, Starts& starts, Eigen::VectorXd const& v, std::span<Run const> runs) {
  MovingAverage::Errors out{v, Eigen::MatrixXd::Zero(average.order(), static_cast<Eigen::Index>(runs.size()))};
  if (average.coefficients.empty()) return out;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    Run const& run = runs[r];
    Start const& start = starts(run.count);
    Eigen::VectorXd const from_zero = divided_by(average.coefficients, v.segment(run.first, run.count));
    Eigen::VectorXd const before = -start.decomposed.solve(with_zeros(from_zero, average.order()));
    out.in_runs.segment(run.first, run.count) = from_zero + start.responses * before;
    out.before.col(static_cast<Eigen::Index>(r)) = before;
  }
  return out;
}

Eigen::MatrixXd turned_by(MovingAverage const& average, Starts& starts, Eigen::MatrixXd const& columns, std::span<Run const> runs) {
  if (average.coefficients.empty()) return columns;
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  for (Run const& run : runs)
    out.middleRows(run.first, run.count) =
        starts(run.count)
            .decomposed.turned(with_zeros(columns.middleRows(run.first, run.count), average.order()))
            .bottomRows(run.count);
  return out;
}

double log_determinant_of(MovingAverage const& average, Starts& starts, std::span<Run const> runs) {
  if (average.coefficients.empty()) return 0;
  double sum = 0;
  for (Run const& run : runs) {
    Eigen::MatrixXd const triangle = starts(run.count).decomposed.triangle();
    for (Eigen::Index k = 0; k < triangle.rows(); ++k) sum += 2 * elementary::log(std::abs(triangle(k, k)));
  }
  return sum;
}

}  // namespace

MovingAverage::Errors MovingAverage::errors(Eigen::VectorXd const& v, std::span<Run const> runs) const {
  Starts starts(coefficients);
  return errors_of(*this, starts, v, runs);
}

Eigen::MatrixXd MovingAverage::slopes(Errors const& e, std::span<Run const> runs) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(e.in_runs.size(), order());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    Run const& run = runs[r];
    Eigen::MatrixXd lagged(run.count, order());
    for (Eigen::Index k = 1; k <= order(); ++k)
      for (Eigen::Index i = 0; i < run.count; ++i)
        lagged(i, k - 1) = i >= k ? e.in_runs(run.first + i - k) : e.before(k - i - 1, static_cast<Eigen::Index>(r));
    out.middleRows(run.first, run.count) = divided_by(coefficients, std::move(lagged));
  }
  return out;
}

Eigen::MatrixXd MovingAverage::turned(Eigen::MatrixXd const& columns, std::span<Run const> runs) const {
  Starts starts(coefficients);
  return turned_by(*this, starts, columns, runs);
}

Eigen::MatrixXd MovingAverage::divided(Eigen::MatrixXd const& columns, std::span<Run const> runs) const {
  Eigen::MatrixXd out = columns;
  for (Run const& run : runs)
    out.middleRows(run.first, run.count) = divided_by(coefficients, columns.middleRows(run.first, run.count));
  return out;
}

Eigen::MatrixXd MovingAverage::freed(Eigen::MatrixXd const& columns, std::span<Run const> runs) const {
  if (coefficients.empty()) return columns;
  Eigen::Index rows = 0, first = 0;
  for (Run const& run : runs) rows += std::max<Eigen::Index>(0, run.count - order());
  Eigen::MatrixXd out(rows, columns.cols());
  std::map<Eigen::Index, OrthogonalTriangular> decomposed;
  for (Run const& run : runs) {
    Eigen::Index const left = run.count - order();
    if (left <= 0) continue;
    auto const place = decomposed.try_emplace(run.count, responses(coefficients, run.count)).first;
    out.middleRows(first, left) = place->second.turned(columns.middleRows(run.first, run.count)).bottomRows(left);
    first += left;
  }
  return out;
}

double MovingAverage::log_determinant(std::span<Run const> runs) const {
  Starts starts(coefficients);
  return log_determinant_of(*this, starts, runs);
}

MovingAverage fitted_moving_average(Eigen::VectorXd const& v, std::span<Run const> runs, MovingAverage from) {
  MovingAverage best = std::move(from);
  Eigen::Index const order = best.order();
  auto const rows = static_cast<double>(v.size());
  for (int round = 0; round < most_rounds && !is_invertible(best.coefficients); ++round) {
    double factor = 1;
    for (double& each : best.coefficients) each *= factor *= moved_out;
  }
  Starts starts(best.coefficients);
  MovingAverage::Errors e = errors_of(best, starts, v, runs);
  double determinant = log_determinant_of(best, starts, runs);
  for (int round = 0; round < most_rounds && order > 0 && e.squares() > 0; ++round) {
    Eigen::VectorXd rise(order);  // of the determinant
    for (Eigen::Index k = 0; k < order; ++k) {
      MovingAverage other = best;
      other.coefficients[static_cast<std::size_t>(k)] += shift;
      rise(k) = (other.log_determinant(runs) - determinant) / shift;
    }
    Eigen::MatrixXd const slopes = turned_by(best, starts, best.slopes(e, runs), runs);
    OrthogonalTriangular const decomposed(slopes);
    Eigen::MatrixXd const root = solve_upper(decomposed.triangle(), Eigen::MatrixXd::Identity(order, order));
    Eigen::VectorXd const step = decomposed.solve(turned_by(best, starts, best.divided(v, runs), runs)) -
                                 e.squares() / (2 * rows) * (root * (root.transpose() * rise));
    double factor = 1, gain = 0;
    for (int halving = 0; halving < most_halvings && gain == 0; ++halving, factor /= 2) {
      MovingAverage next = best;
      for (Eigen::Index k = 0; k < order; ++k) next.coefficients[static_cast<std::size_t>(k)] += factor * step(k);
      if (!is_invertible(next.coefficients)) continue;
      Starts its_starts(next.coefficients);
      MovingAverage::Errors left = errors_of(next, its_starts, v, runs);
      double const its_determinant = log_determinant_of(next, its_starts, runs);
      double const lower = rows * elementary::log(e.squares() / left.squares()) + determinant - its_determinant;
      if (!(lower > 0)) continue;
      gain = lower;
      best = std::move(next);
      e = std::move(left);
      determinant = its_determinant;
      starts = std::move(its_starts);
    }
    if (gain <= enough) break;
  }
  return best;
}

}  // namespace sysid::regression
