// The target's own derivatives; else differences on both sides of a place, or twice inwards at an end of the box.
#include "search/box_quadratic.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/local_slopes.hpp"

namespace sysid {
namespace {

constexpr double of_prior = 1e-3;                          // prior widths: differences of the prior, whose second ones are needed
constexpr double of_distance = 0.03;                       // of the way to an end
constexpr double nearest_low = 1e-9, nearest_high = 1e-5;  // nearer ends are reached; below 1 there are fewer numbers than above 0

/// Offsets of the two differences of one coordinate: on both sides, or twice inwards where an end is nearer than the width.
struct Pair {
  double first, second;

  double slope(double at, double f, double s) const {
    return (second * second * (f - at) - first * first * (s - at)) / (first * second * (second - first));
  }
  double bend(double at, double f, double s) const { return 2 * ((s - at) / second - (f - at) / first) / (second - first); }
};

/// Where differences are taken: z + t axis for the two t of a pair.
struct Differences {
  Eigen::MatrixXd axes;  // [P x P] columns
  std::vector<Pair> pairs;
};

/// Each axis as long as it is where the box has room on both sides; else twice inwards.
Differences with_room(Box const& box, Eigen::VectorXd const& z, Eigen::MatrixXd axes) {
  Differences differences{std::move(axes), {}};
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    double ahead = infinity, behind = infinity;
    for (Eigen::Index p = 0; p < z.size(); ++p) {
      double const a = differences.axes(p, k), up = box.high()(p) - z(p), down = z(p) - box.low()(p);
      if (a == 0) continue;
      ahead = std::min(ahead, (a > 0 ? up : down) / std::fabs(a));
      behind = std::min(behind, (a > 0 ? down : up) / std::fabs(a));
    }
    double const most = std::max(ahead, behind), inwards = std::min(1.0, most / 2) * (ahead >= behind ? 1 : -1);
    differences.pairs.push_back(std::min(ahead, behind) >= 1 ? Pair{1, -1} : Pair{inwards, 2 * inwards});
  }
  return differences;
}

Differences along_parameters(Box const& box, Eigen::VectorXd const& z, double width) {
  return with_room(box, z, Eigen::MatrixXd((width * box.width()).asDiagonal()));
}

/// For a rough target: along the axes of the ellipsoid, as long as the roughness may drown what is shorter and no longer than the
/// density is normal. A step along a parameter would see little but the narrow direction. Parameters near an end go by themselves.
Differences along_axes(Box const& box, Eigen::VectorXd const& z, Eigen::MatrixXd const& curvature, double least) {
  constexpr double part = 0.2, most = 0.05;  // sds; prior widths
  Eigen::Index const n = z.size();
  Eigen::VectorXd const& w = box.width();
  Eigen::VectorXd unit(n);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index p = 0; p < n; ++p) {
    double const sd = curvature(p, p) > 0 ? 1 / std::sqrt(curvature(p, p)) : infinity;
    unit(p) = std::clamp(part * sd, least * w(p), most * w(p));
    if (z(p) - unit(p) >= box.low()(p) && z(p) + unit(p) <= box.high()(p)) inside.push_back(p);
  }
  Eigen::MatrixXd axes = unit.asDiagonal();
  if (!inside.empty()) {
    Eigen::VectorXd const u = unit(inside);
    auto const [values, vectors] = symmetric_eigen(u.asDiagonal() * curvature(inside, inside) * u.asDiagonal());
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      Eigen::VectorXd axis = u.cwiseProduct(vectors.col(k));
      double const widths = axis.cwiseQuotient(w(inside)).cwiseAbs().maxCoeff();
      axis *= std::min(values(k) > 0 ? part / std::sqrt(values(k)) : infinity, most / widths);
      axes(inside, inside[static_cast<std::size_t>(k)]) = axis;
    }
  }
  return axes.allFinite() ? with_room(box, z, std::move(axes)) : along_parameters(box, z, least);
}

/// The place itself, then those of the pairs.
void add_places(Box const& box, Eigen::VectorXd const& z, Differences const& differences, std::vector<Eigen::VectorXd>& points) {
  points.push_back(box.outside(z));
  for (std::size_t k = 0; k < differences.pairs.size(); ++k)
    for (double const by : {differences.pairs[k].first, differences.pairs[k].second})
      points.push_back(box.outside(z + by * differences.axes.col(static_cast<Eigen::Index>(k))));
}

/// residuals [R x L]: the columns of a place and its differences from `first` on.
Quadratic of_residuals(ConstLanes residuals, int first, Differences const& differences) {
  int const rows = residuals.rows();
  Eigen::Index const n = differences.axes.cols();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, n);
  Eigen::VectorXd centre(rows);
  for (int r = 0; r < rows; ++r) centre(r) = residuals(r, first);
  for (Eigen::Index p = 0; p < n; ++p) {
    int const a = first + 1 + 2 * static_cast<int>(p), b = a + 1;
    bool const near = rows > 0 && std::isfinite(residuals(0, a)), far = rows > 0 && std::isfinite(residuals(0, b));
    Pair const& pair = differences.pairs[static_cast<std::size_t>(p)];
    for (int r = 0; r < rows; ++r) {  // both neighbours failed: the coordinate is left alone
      if (near && far)
        jacobian(r, p) = pair.slope(centre(r), residuals(r, a), residuals(r, b));
      else if (near)
        jacobian(r, p) = (residuals(r, a) - centre(r)) / pair.first;
      else if (far)
        jacobian(r, p) = (residuals(r, b) - centre(r)) / pair.second;
    }
  }
  jacobian *= inverse(differences.axes);
  return {-jacobian.transpose() * centre, jacobian.transpose() * jacobian};
}

void add_prior_at(Objective const& objective, Box const& box, Eigen::VectorXd const& z, Quadratic& quadratic) {
  if (objective.objective_kind == ObjectiveKind::likelihood) return;
  // A density whose logarithm falls as that of the distance from a bound is no parabola over a step of that length.
  Eigen::VectorXd widths = of_prior * box.width();
  for (Eigen::Index p = 0; p < z.size(); ++p)
    if (double const low = z(p) - box.low()(p), high = box.high()(p) - z(p); low > nearest_low && high > nearest_high)
      widths(p) = std::min(widths(p), of_distance * std::min(low, high));
  Differences const differences = with_room(box, z, Eigen::MatrixXd(widths.asDiagonal()));
  std::vector<Eigen::VectorXd> points;
  add_places(box, z, differences, points);
  std::vector<double> const f = objective.log_prior(to_lanes(points));
  for (Eigen::Index p = 0; p < z.size(); ++p) {
    Pair const& pair = differences.pairs[static_cast<std::size_t>(p)];
    auto const at = static_cast<std::size_t>(1 + 2 * p);
    double const h = differences.axes(p, p), slope = pair.slope(f[0], f[at], f[at + 1]) / h,
                 bend = -pair.bend(f[0], f[at], f[at + 1]) / (h * h);
    if (std::isfinite(slope)) quadratic.gradient(p) += slope;
    if (std::isfinite(bend) && bend > 0) quadratic.curvature(p, p) += bend;
  }
}

}  // namespace

namespace {

/// By the target's own derivatives. Where it has none of a place, nothing.
std::vector<std::optional<Quadratic>> by_derivatives(Objective const& objective, Box const& box,
                                                     std::vector<Eigen::VectorXd> const& places, Ledger& ledger) {
  int const n = objective.dimension();
  std::vector<Eigen::VectorXd> outside;
  for (Eigen::VectorXd const& z : places) outside.push_back(box.outside(z));
  Eigen::VectorXd const steps = difference_width(objective.target) * objective.scale;  // of what the derivatives leave out
  std::vector<LikelihoodSlope> const slopes = local_slopes(objective.target, to_lanes(outside), steps, ledger);
  std::vector<std::optional<Quadratic>> quadratics(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    Eigen::VectorXd const slope = box.slope(outside[k]);
    Quadratic made{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
    for (int p = 0; p < n; ++p) {
      made.gradient(p) = slopes[k].gradient(p) / slope(p);
      for (int q = 0; q < n; ++q) made.curvature(p, q) = slopes[k].curvature(p, q) / (slope(p) * slope(q));
    }
    bool const known = made.gradient.allFinite() && made.curvature.allFinite() && !made.curvature.isZero(0);
    if (known) quadratics[k] = std::move(made);
  }
  return quadratics;
}

std::vector<Quadratic> by_differences(Objective const& objective, Box const& box, std::vector<Eigen::VectorXd> const& places,
                                      std::vector<Eigen::MatrixXd> const& curvatures, Ledger& ledger) {
  double const least = difference_width(objective.target);
  std::vector<Differences> differences;
  std::vector<Eigen::VectorXd> points;
  for (std::size_t k = 0; k < places.size(); ++k) {
    bool const rough = objective.target.roughness() > 0 && curvatures[k].size() > 0 && curvatures[k].allFinite();
    differences.push_back(rough ? along_axes(box, places[k], curvatures[k], least) : along_parameters(box, places[k], least));
    add_places(box, places[k], differences.back(), points);
  }
  LaneArray residuals(objective.target.residual_count(), static_cast<int>(points.size()));
  objective.target.residuals(to_lanes(points), residuals, ledger);
  std::vector<Quadratic> quadratics;
  int const columns = 1 + 2 * objective.dimension();
  for (std::size_t k = 0; k < places.size(); ++k)
    quadratics.push_back(of_residuals(residuals, static_cast<int>(k) * columns, differences[k]));
  return quadratics;
}

}  // namespace

std::vector<Quadratic> quadratics_at(Objective const& objective, Box const& box, std::vector<Eigen::VectorXd> const& places,
                                     std::vector<Eigen::MatrixXd> const& curvatures, Ledger& ledger) {
  // Of a long record with little noise the sds are as short as differences can be, over which the residuals bend.
  bool const exact = objective.target.derivatives() == DerivativeSource::exact && objective.target.roughness() == 0;
  std::vector<std::optional<Quadratic>> known(places.size());
  if (exact) known = by_derivatives(objective, box, places, ledger);
  std::vector<Eigen::VectorXd> left;
  std::vector<Eigen::MatrixXd> of_left;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (!known[k]) left.push_back(places[k]), of_left.push_back(curvatures[k]);
  std::vector<Quadratic> differenced;
  if (!left.empty()) differenced = by_differences(objective, box, left, of_left, ledger);
  std::vector<Quadratic> quadratics;
  std::size_t next = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    quadratics.push_back(std::move(known[k] ? *known[k] : differenced[next++]));
    add_prior_at(objective, box, places[k], quadratics.back());
  }
  return quadratics;
}

}  // namespace sysid
