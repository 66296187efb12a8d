// Null spaces of scaled slopes, and which of their directions are the same at every draw.
#include "diagnostics/identifiability/identifiability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/numeric/statistics.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double worst_floor = 1e-2;
constexpr double same_direction = 1e-2;   // rms angle between draws, in radians
constexpr double negligible_part = 1e-3;  // of the largest coefficient

/// The null space at one draw: columns are moves in units of scale.
struct LocalNull {
  LocalSlopes const* at;
  std::vector<bool> silent;  // [P] no influence here
  double floor = 0;
  Matrix basis;  // [P x nullity], not orthogonal; silent parameters have zero rows
  int above_noise = 0;
};

LocalNull local_null(LocalSlopes const& draw, std::vector<bool> const& excluded) {
  Sensitivity const& s = draw.sensitivity;
  Eigen::Index const n = s.slopes.cols();
  LocalNull result{&draw, std::vector<bool>(static_cast<std::size_t>(n)), 0, {}, 0};
  double square = s.nuisance_error * s.nuisance_error;
  std::vector<Eigen::Index> kept;
  Vector length(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    length(p) = s.slopes.col(p).norm();
    bool const silent = !(length(p) > 3 * s.error(p)) || !(length(p) > 1e-10 * s.size);
    result.silent[static_cast<std::size_t>(p)] = silent;
    if (silent) length(p) = std::max(length(p), std::numeric_limits<double>::min());
    if (excluded[static_cast<std::size_t>(p)]) continue;
    kept.push_back(p);
    if (!silent) square += (s.error(p) / length(p)) * (s.error(p) / length(p));
  }
  result.floor = 2 * std::sqrt(square) + 1e-12;
  auto const m = static_cast<Eigen::Index>(kept.size());
  Matrix scaled(n, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    Eigen::Index const p = kept[static_cast<std::size_t>(k)];
    scaled.col(k) = result.silent[static_cast<std::size_t>(p)] ? Vector::Zero(n).eval() : (s.slopes.col(p) / length(p)).eval();
  }
  result.above_noise = static_cast<int>(m);
  if (m == 0) return result;
  SingularValues const svd = singular_values(scaled);
  Vector const& values = svd.values;
  int nullity = 0;
  for (Eigen::Index k = 0; k < m; ++k)
    if (k >= values.size() || values(k) < result.floor) ++nullity;
  result.basis = Matrix::Zero(n, nullity);
  for (int j = 0; j < nullity; ++j)
    for (Eigen::Index k = 0; k < m; ++k) {
      Eigen::Index const p = kept[static_cast<std::size_t>(k)];
      double const unit = result.silent[static_cast<std::size_t>(p)] ? 1 : 1 / length(p);
      result.basis(p, j) = svd.right(k, m - nullity + j) * unit;
    }
  return result;
}

Matrix orthonormal(Matrix const& columns) {
  if (columns.cols() == 0) return columns;
  return OrthogonalTriangular(columns).basis();
}

/// Directions that lie in every one of the spaces: eigenvectors of the mean projector onto their complements with eigenvalue (mean
/// squared sine) near zero.
Matrix common(std::vector<Matrix> const& spaces, Eigen::Index dimension) {
  Matrix complement = Matrix::Zero(dimension, dimension);
  for (Matrix const& space : spaces) {
    Matrix const q = orthonormal(space);
    complement += Matrix::Identity(dimension, dimension) - q * q.transpose();
  }
  auto const [values, vectors] = symmetric_eigen(complement / static_cast<double>(spaces.size()));
  Eigen::Index count = 0;
  while (count < dimension && values(count) < same_direction * same_direction) ++count;
  return vectors.leftCols(count);
}

/// A basis with as many zeros as elimination with full pivoting gives: rows of the reduced echelon form of the transpose.
std::vector<Vector> sparse_basis(Matrix space) {
  Matrix rows = space.transpose();
  std::vector<bool> used(static_cast<std::size_t>(rows.cols()));
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    Eigen::Index pivot_row = r, pivot = 0;
    double largest = -1;
    for (Eigen::Index i = r; i < rows.rows(); ++i)
      for (Eigen::Index p = 0; p < rows.cols(); ++p)
        if (!used[static_cast<std::size_t>(p)] && std::abs(rows(i, p)) > largest)
          largest = std::abs(rows(i, p)), pivot_row = i, pivot = p;
    rows.row(r).swap(rows.row(pivot_row));
    used[static_cast<std::size_t>(pivot)] = true;
    rows.row(r) /= rows(r, pivot);
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      if (i != r) rows.row(i) -= rows(i, pivot) * rows.row(r);
  }
  std::vector<Vector> basis;
  for (Eigen::Index r = 0; r < rows.rows(); ++r) basis.emplace_back(rows.row(r).transpose());
  return basis;
}

/// The same direction with small whole or half numbers, the first of them positive, where there is one.
Vector simple(Vector direction) {
  double const largest = direction.cwiseAbs().maxCoeff();
  for (double& c : direction)
    if (std::abs(c) < negligible_part * largest) c = 0;
  auto const fits = [&](double unit, double grain) {
    for (double const c : direction) {
      double const x = c / unit / grain;
      if (std::abs(x - std::round(x)) > 5e-3 / grain || std::abs(x * grain) > 6) return false;
    }
    return true;
  };
  Eigen::Index first = 0;
  while (first + 1 < direction.size() && direction(first) == 0) ++first;
  for (double const grain : {1.0, 0.5})
    for (double const unit : direction) {
      if (unit == 0 || !fits(unit, grain)) continue;
      double const signed_unit = direction(first) / unit < 0 ? -unit : unit;
      for (double& c : direction) c = std::round(c / signed_unit / grain) * grain;
      return direction;
    }
  return direction / direction(first);
}

NullDirection named(NullDirection::Kind kind, Vector const& direction, Vector const& natural) {
  NullDirection result{kind, {}};
  double const largest = direction.cwiseAbs().maxCoeff();
  for (Eigen::Index p = 0; p < direction.size(); ++p)
    if (std::abs(direction(p)) > negligible_part * largest) result.parts.push_back({static_cast<int>(p), direction(p), natural(p)});
  return result;
}

}  // namespace

NullSpace find_null_space(std::span<LocalSlopes const> draws) {
  NullSpace result;
  if (draws.empty()) return result;
  Eigen::Index const n = draws.front().value.size();
  // Without influence at every draw: said apart, and left out of what follows.
  std::vector<bool> excluded(static_cast<std::size_t>(n));
  std::vector<LocalNull> all;
  for (LocalSlopes const& draw : draws)
    if (draw.sensitivity.finite) all.push_back(local_null(draw, excluded));
  std::erase_if(all, [](LocalNull const& each) { return each.floor > worst_floor; });
  result.draws = static_cast<int>(all.size());
  if (all.empty()) return result;
  for (Eigen::Index p = 0; p < n; ++p) {
    auto const i = static_cast<std::size_t>(p);
    excluded[i] = std::all_of(all.begin(), all.end(), [&](LocalNull const& each) { return each.silent[i]; });
    if (excluded[i]) result.directions.push_back({NullDirection::Kind::no_influence, {{static_cast<int>(p), 1, 0}}});
  }
  for (LocalNull& each : all) each = local_null(*each.at, excluded);
  int const silent = static_cast<int>(result.directions.size());
  int dimension = std::numeric_limits<int>::max();
  for (LocalNull const& each : all) {
    int const here = static_cast<int>(each.basis.cols());
    dimension = std::min(dimension, here);
    result.dimensions.push_back(here + silent);
  }
  if (dimension == 0) return result;

  LocalNull const& first = all.front();
  Matrix found(n, 0);  // natural moves at the first draw, in units of scale
  auto const take = [&](NullDirection::Kind kind, std::vector<Matrix> const& spaces, Vector const& to_natural, bool natural_chart) {
    for (Vector direction : sparse_basis(common(spaces, n))) {
      if (found.cols() >= dimension) return;
      if (natural_chart) direction = direction.cwiseProduct(to_natural);
      direction = simple(direction);
      Vector const natural = natural_chart ? direction : direction.cwiseProduct(to_natural).eval();
      result.directions.push_back(named(kind, direction, natural));
      found.conservativeResize(Eigen::NoChange, found.cols() + 1);
      found.col(found.cols() - 1) = natural.cwiseQuotient(first.at->scale);
    }
  };
  std::vector<Matrix> relative, natural;
  Vector unit(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    std::vector<double> spreads;
    for (LocalNull const& each : all) spreads.push_back(each.at->spread(p) * each.at->scale(p));
    unit(p) = upper_median(spreads);
  }
  for (LocalNull const& each : all) {
    // A parameter at zero has no logarithm: its own move stays out of the relative chart.
    Vector const share = each.at->value.unaryExpr([](double v) { return v != 0 ? 1 / v : 0.0; });
    relative.push_back((each.at->scale.cwiseProduct(share)).asDiagonal() * each.basis);
    natural.push_back((each.at->scale.cwiseQuotient(unit)).asDiagonal() * each.basis);
  }
  take(NullDirection::Kind::scaling, relative, first.at->value, false);
  take(NullDirection::Kind::sum, natural, unit, true);
  if (found.cols() == dimension) return result;

  // What is left at the first draw, orthogonal to what has a name.
  Vector const spread = first.at->spread;
  Matrix const space = orthonormal(spread.cwiseInverse().asDiagonal() * first.basis);
  Matrix rest = space;
  if (found.cols() > 0) {
    Matrix const known = orthonormal(spread.cwiseInverse().asDiagonal() * found);
    rest -= known * (known.transpose() * space);
  }
  int const missing = dimension - static_cast<int>(found.cols());
  for (Vector const& direction : sparse_basis(singular_values(rest).left.leftCols(missing)))
    result.directions.push_back(
        named(NullDirection::Kind::general, direction / direction.cwiseAbs().maxCoeff(),
              (direction / direction.cwiseAbs().maxCoeff()).cwiseProduct(spread).cwiseProduct(first.at->scale)));
  return result;
}

Expectation expect(LocalSlopes const& draw) {
  Matrix const slopes = draw.sensitivity.slopes * draw.spread.asDiagonal();
  Eigen::Index const n = slopes.cols();
  // By singular values of the slopes themselves: their square would lose the weak directions beside the strong ones.
  SingularValues const svd = singular_values(slopes);
  Vector const kept = (svd.values.array().square() + 1).inverse();
  Matrix const covariance = svd.right * kept.asDiagonal() * svd.right.transpose();
  Expectation result{covariance.diagonal().cwiseSqrt(), Matrix(n, n)};
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) result.correlation(i, j) = covariance(i, j) / (result.shrinkage(i) * result.shrinkage(j));
  return result;
}

}  // namespace sysid
