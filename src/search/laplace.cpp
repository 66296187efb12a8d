// Newton's method and Laplace's approximation over lanes.
#include "search/laplace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/ridge.hpp"
#include "search/settle.hpp"

namespace sysid {
namespace {

constexpr double curvature_step = 0.3;  // conditional sds: log density falls by 0.045, far above its rounding
constexpr double close_enough = 1e-8;   // Newton decrement: 1e-4 sd from the optimum
constexpr double flat_move = 0.1;       // prior widths that a flat direction is shown over
/// Curvatures below this share of a conditional width's are rounding: of second differences along the parameters, where those along
/// narrow directions drown them; and of the sums that turn differences along the axes into a matrix.
constexpr double rounding = 1e-11, rounding_along_axes = 1e-14;

/// Value, gradient and minus the second derivatives of the log density, in units of the columns of `steps` [P x P].
struct Local {
  double value = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
  bool finite = true;
};

Local local_shape(Objective const& objective, Eigen::VectorXd const& theta, Eigen::MatrixXd const& steps, bool full,
                  Ledger& ledger) {
  Eigen::Index const n = theta.size();
  std::vector<Eigen::VectorXd> points = {theta};
  auto const moved = [&](Eigen::Index i, double a, Eigen::Index j, double b) {
    return Eigen::VectorXd(theta + (a * steps.col(i) + b * steps.col(j)));
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    points.push_back(moved(i, 1, i, 0));
    points.push_back(moved(i, -1, i, 0));
  }
  for (Eigen::Index i = 0; full && i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      points.push_back(moved(i, 1, j, 1));
      points.push_back(moved(i, 1, j, -1));
      points.push_back(moved(i, -1, j, 1));
      points.push_back(moved(i, -1, j, -1));
    }
  }
  std::vector<double> const f = log_density_in_blocks(objective, to_lanes(points), ledger);
  Local local{f[0], Eigen::VectorXd(n), Eigen::MatrixXd::Zero(n, n)};
  local.finite = std::all_of(f.begin(), f.end(), [](double v) { return std::isfinite(v); });
  if (!local.finite) return local;
  std::size_t next = 1;
  for (Eigen::Index i = 0; i < n; ++i, next += 2) {
    local.gradient(i) = (f[next] - f[next + 1]) / 2;
    local.curvature(i, i) = 2 * f[0] - f[next] - f[next + 1];
  }
  for (Eigen::Index i = 0; full && i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j, next += 4)
      local.curvature(i, j) = local.curvature(j, i) = -(f[next] - f[next + 1] - f[next + 2] + f[next + 3]) / 4;
  return local;
}

/// Eigenvalues of a curvature, held at or above the prior's own order: a direction that the data leave alone is a few prior widths
/// long, not infinite. Units are conditional widths where those are narrower than the prior's: a parameter known to a billionth
/// would else leave its rounding in all others.
struct Spectrum {
  Eigen::VectorXd unit;                // [P]
  Eigen::VectorXd values;              // > 0
  Eigen::MatrixXd vectors;             // columns, in units
  std::vector<Eigen::Index> flat;      // longer than ten prior widths
  std::vector<Eigen::Index> doubtful;  // longer than is measured along the parameters, which may be much less than a prior width
  Eigen::VectorXd measured;
};

Spectrum spectrum_of(Eigen::MatrixXd const& curvature, Eigen::VectorXd const& scale) {
  Eigen::VectorXd unit = scale;
  for (Eigen::Index i = 0; i < unit.size(); ++i)
    if (curvature(i, i) > 0) unit(i) = std::min(scale(i), 1 / std::sqrt(curvature(i, i)));
  auto [values, vectors] = symmetric_eigen(unit.asDiagonal() * curvature * unit.asDiagonal());
  Spectrum spectrum{unit, values, std::move(vectors), {}, {}, values};
  for (Eigen::Index k = 0; k < unit.size(); ++k) {
    double const length = spectrum.vectors.col(k).cwiseProduct(unit).cwiseQuotient(scale).norm();
    double const of_prior = length * length / (longest_width * longest_width), least = std::max(of_prior, rounding);
    if (spectrum.values(k) >= least) continue;
    (of_prior < rounding ? spectrum.doubtful : spectrum.flat).push_back(k);
    spectrum.values(k) = std::max(std::fabs(spectrum.values(k)), least);
  }
  return spectrum;
}

Eigen::MatrixXd covariance_from(Spectrum const& s) {
  Eigen::MatrixXd const vectors = s.unit.asDiagonal() * s.vectors;
  return vectors * s.values.cwiseInverse().asDiagonal() * vectors.transpose();
}

Eigen::VectorXd widths_from(Eigen::MatrixXd const& curvature, Eigen::VectorXd const& scale) {
  Eigen::VectorXd width(scale.size());
  for (Eigen::Index i = 0; i < width.size(); ++i) {
    double const bend = curvature(i, i);
    double const conditional = bend > 0 && std::isfinite(bend) ? 1 / std::sqrt(bend) : scale(i);
    width(i) = curvature_step * std::min(conditional, scale(i));
  }
  return width;
}

/// Where a shape is measured: along the parameters, or, where they are strongly correlated, along the axes of the ellipsoid. There
/// a step along a parameter sees little but the narrow direction, and what rounding or a rough solver leaves in the log density
/// drowns the wide one. A shape that is not measured in full is, along these axes, nearly what is measured of it.
struct Steps {
  Eigen::MatrixXd columns;
  bool along_parameters;
};

Steps steps_from(Eigen::MatrixXd const& curvature, Eigen::VectorXd const& scale, bool full) {
  constexpr double strongly = 1e-2;  // smallest eigenvalue of the scaled curvature: a correlation of 0.99
  Spectrum const spectrum = spectrum_of(curvature, scale);
  if (!curvature.allFinite() || (full && spectrum.values.minCoeff() > strongly))
    return {Eigen::MatrixXd(widths_from(curvature, scale).asDiagonal()), true};
  Steps steps{spectrum.unit.asDiagonal() * spectrum.vectors, false};
  for (Eigen::Index k = 0; k < scale.size(); ++k) {
    double const widths = steps.columns.col(k).cwiseQuotient(scale).norm();
    steps.columns.col(k) *= curvature_step * std::min(1 / std::sqrt(spectrum.values(k)), 1 / widths);
  }
  return steps;
}

/// Whether `steps` were right for a shape: each a third to three times as long as it asks for.
bool fitting(Steps const& steps, Local const& local, Steps const& wanted) {
  if (steps.along_parameters != wanted.along_parameters) return false;
  if (steps.along_parameters) {
    Eigen::ArrayXd const now = wanted.columns.diagonal().array(), former = steps.columns.diagonal().array();
    return (now < 3 * former).all() && (now > former / 3).all();
  }
  constexpr double asked = curvature_step * curvature_step;
  // Where the prior's width is the limit, the curvature may be as small as it likes.
  return (local.curvature.diagonal().array() < 9 * asked).all();
}

/// Declared values and sds; the derivative [P x P] of the declared values.
Eigen::MatrixXd fill_declared(Target const& target, Eigen::VectorXd const& theta, Eigen::MatrixXd const& covariance, Mode& mode) {
  Eigen::Index const n = theta.size();
  std::vector<Eigen::VectorXd> points = {theta};
  Eigen::VectorXd const step = 1e-3 * covariance.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (double const sign : {1.0, -1.0}) {
      points.push_back(theta);
      points.back()(i) += sign * step(i);
    }
  }
  LaneArray const lanes = to_lanes(points);
  LaneArray declared(lanes.rows(), lanes.width());
  target.constrain(lanes, declared);
  Eigen::MatrixXd slope(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index p = 0; p < n; ++p)
      slope(p, i) = (declared(static_cast<int>(p), static_cast<int>(1 + 2 * i)) -
                     declared(static_cast<int>(p), static_cast<int>(2 + 2 * i))) /
                    (2 * step(i));
  Eigen::MatrixXd const spread = slope * covariance * slope.transpose();
  for (Eigen::Index p = 0; p < n; ++p) {
    mode.declared.push_back(declared(static_cast<int>(p), 0));
    mode.sd.push_back(std::sqrt(std::max(0.0, spread(p, p))));
  }
  return slope;
}

/// A flat direction as moves of the declared parameters, without those that hardly take part.
void add_flat(Eigen::VectorXd move, Eigen::VectorXd const& scale, Eigen::MatrixXd const& slope, Mode& mode) {
  Eigen::VectorXd const widths = move.cwiseQuotient(scale);
  double const largest = widths.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < move.size(); ++i)
    if (std::fabs(widths(i)) < 0.1 * largest) move(i) = 0;
  Eigen::VectorXd const declared = slope * move * (flat_move / largest);
  mode.flat.insert(mode.flat.end(), declared.begin(), declared.end());
}

/// Directions so much longer than the narrowest that the curvature alone does not tell whether they are flat: they are if the
/// likelihood has a ridge there, else as long as is measured along the axes.
void settle_doubts(Objective const& objective, Eigen::VectorXd const& theta, bool along_parameters, Spectrum& spectrum,
                   Ledger& ledger) {
  for (Eigen::Index const k : spectrum.doubtful) {
    Eigen::VectorXd const move = spectrum.unit.cwiseProduct(spectrum.vectors.col(k));
    double const widths = move.cwiseQuotient(objective.scale).cwiseAbs().maxCoeff();
    if (objective.target.is_expensive() || is_ridge(objective, theta, move * (flat_move / widths), ledger))
      spectrum.flat.push_back(k);
    else if (!along_parameters && spectrum.measured(k) > rounding_along_axes)
      spectrum.values(k) = spectrum.measured(k);
  }
}

/// Whether all that moves much along `step`, in widths of the prior, lies between two bounds: a prior of another kind gives its own
/// width to a ridge of the likelihood.
bool is_between_bounds(Objective const& objective, Eigen::VectorXd const& step) {
  for (Eigen::Index p = 0; p < step.size(); ++p) {
    ParameterInfo const& info = objective.target.parameters()[static_cast<std::size_t>(p)];
    if (std::fabs(step(p)) > 0.3 * step.norm() && !(std::isfinite(info.lower) && std::isfinite(info.upper))) return false;
  }
  return true;
}

/// Directions that are measured as about as long as the prior is wide: the differences that measure them are taken on a straight
/// line of that length, which leaves a ridge that bends, as p q = 1 does in the coordinates of an interval. They are flat if the
/// ridge goes on, both ways, to where a normal density of this width has fallen by six nats: that of the likelihood, and of the
/// density with its prior, so that a parameter whose prior alone has a width has it. On the sampler's coordinates the prior bends
/// with them, and what is flat there has been found at the optimum of the declared density.
void follow_long_directions(Objective const& objective, Eigen::VectorXd const& theta, Spectrum& spectrum, Ledger& ledger) {
  constexpr double as_long = 0.5, sds = 3.5;
  if (objective.objective_kind == ObjectiveKind::posterior || objective.target.is_expensive()) return;
  for (Eigen::Index k = 0; k < spectrum.values.size(); ++k) {
    if (std::find(spectrum.flat.begin(), spectrum.flat.end(), k) != spectrum.flat.end()) continue;
    Eigen::VectorXd const sd = spectrum.unit.cwiseProduct(spectrum.vectors.col(k)) / std::sqrt(spectrum.values(k));
    Eigen::VectorXd const in_widths = sd.cwiseQuotient(objective.scale);
    if (in_widths.norm() < as_long) continue;
    if (objective.objective_kind != ObjectiveKind::likelihood && !is_between_bounds(objective, in_widths)) continue;
    if (is_ridge_both_ways(objective, theta, sds * sd, ledger)) spectrum.flat.push_back(k);
  }
}

}  // namespace

Eigen::VectorXd theta_of(Mode const& mode) {
  return Eigen::Map<Eigen::VectorXd const>(mode.theta.data(), static_cast<Eigen::Index>(mode.theta.size()));
}

Eigen::MatrixXd covariance_at_power(Mode const& mode, double power, Eigen::VectorXd const& widths) {
  Eigen::MatrixXd precision = power * inverse(covariance_of(mode));
  precision.diagonal() += (1 - power) * widths.cwiseAbs2().cwiseInverse();
  return inverse(precision);
}

Eigen::MatrixXd covariance_of(Mode const& mode) {
  auto const n = static_cast<Eigen::Index>(mode.theta.size());
  return Eigen::Map<Eigen::MatrixXd const>(mode.covariance.data(), n, n);
}

double distance(Mode const& a, Mode const& b) {
  Eigen::VectorXd const gap = theta_of(a) - theta_of(b);
  return std::sqrt(std::max(0.0, gap.dot(solve_symmetric(covariance_of(a) + covariance_of(b), gap))));
}

Mode laplace_mode(Objective const& objective, Eigen::VectorXd theta, Eigen::MatrixXd const& guess, Ledger& ledger, int most_steps) {
  Eigen::VectorXd const& scale = objective.scale;
  bool const full = objective.dimension() <= most_measured_in_full;
  Steps steps = steps_from(guess, scale, full);
  Eigen::MatrixXd curvature = guess;
  double value = 0, gain = infinity;
  for (int step = 0; step < most_steps; ++step) {
    Local const local = local_shape(objective, theta, steps.columns, full, ledger);
    value = local.value;
    if (!local.finite) {  // a failing region is near: look closer
      steps.columns *= 0.25;
      continue;
    }
    Eigen::MatrixXd const back =
        steps.along_parameters ? Eigen::MatrixXd(steps.columns.diagonal().cwiseInverse().asDiagonal()) : inverse(steps.columns);
    Eigen::VectorXd const gradient = back.transpose() * local.gradient;
    curvature = back.transpose() * local.curvature * back;
    Eigen::MatrixXd const covariance = covariance_from(spectrum_of(curvature, scale));
    Eigen::VectorXd const move = covariance * gradient;
    Steps const former = std::exchange(steps, steps_from(curvature, scale, full));
    // Steps far from what the curvature here asks for would blur it: measure again before believing.
    bool const believed = fitting(former, local, steps);
    gain = 0.5 * gradient.dot(move);
    if (gradient.dot(move) < close_enough && (believed || step + 1 == most_steps)) break;
    std::vector<Eigen::VectorXd> trials;
    for (double const part : {1.0, 0.5, 0.2, 0.05, 0.01}) trials.push_back(objective.clamp(theta + part * move, theta));
    std::vector<double> const reached = log_density_in_blocks(objective, to_lanes(trials), ledger);
    auto const best = std::max_element(reached.begin(), reached.end());
    if (*best > value) {
      theta = trials[static_cast<std::size_t>(best - reached.begin())];
      value = *best;
    } else if (believed) {
      break;
    }
  }
  Spectrum spectrum = spectrum_of(curvature, scale);
  settle_doubts(objective, theta, steps.along_parameters, spectrum, ledger);
  follow_long_directions(objective, theta, spectrum, ledger);
  Eigen::MatrixXd const covariance = covariance_from(spectrum);
  Eigen::Index const n = theta.size();
  Mode mode;
  mode.theta.assign(theta.data(), theta.data() + n);
  mode.covariance.assign(covariance.data(), covariance.data() + n * n);
  mode.log_density = value;
  mode.log_mass = value;
  for (Eigen::Index i = 0; i < n; ++i)
    mode.log_mass += elementary::log(spectrum.unit(i)) + 0.5 * elementary::log(2 * std::numbers::pi / spectrum.values(i));
  Eigen::MatrixXd const slope = fill_declared(objective.target, theta, covariance, mode);
  if (objective.objective_kind != ObjectiveKind::posterior) mode.log_mass += log_absolute_determinant(slope);
  mode.gain = gain;
  if (!objective.target.is_expensive()) {
    Outlook const outlook = look_ahead(objective, theta, inverse(covariance));
    mode.gain = outlook.gain;
    mode.log_mass += outlook.log_mass;
  }
  for (Eigen::Index const k : spectrum.flat) add_flat(spectrum.unit.cwiseProduct(spectrum.vectors.col(k)), scale, slope, mode);
  return mode;
}

}  // namespace sysid
