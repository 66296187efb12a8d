// Differences, elimination of the starts, damped steps.
#include "likelihood/shooting.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/elementary.hpp"

namespace sysid {
namespace {

// What a perturbation moves the outputs by, in their sds: small against curvature, which is large where neighbours part, and large
// against rounding or against the tolerance that an adaptive solver keeps. Within the factor a slope serves.
constexpr double smooth_effect = 1e-6, rough_effect = 1e-4;
constexpr double near_enough = 100;
constexpr int most_probes = 12;
constexpr double largest_step = 1e30;  // where nothing shows
constexpr double least_noise = 1e-9;   // of the channel's sd
constexpr double ridge = 1e-12;        // on starts, of their own column: those that a segment does not show stay where they are
constexpr double first_damping = 1e-3, most_damping = 1e10, least_damping = 1e-12;
constexpr double rough = 1000;         // gains that are not met by this many times the smallest are the solver's roughness
constexpr double same_columns = 1e-9;  // what is left of a coefficient's column once the others have explained theirs

/// Perturbations, as large as show.
struct Steps {
  Eigen::VectorXd coefficient;  // [k]
  Eigen::MatrixXd start;        // [states x segments]
};

double first_step(double value) { return value != 0 ? smooth_effect * std::abs(value) : smooth_effect; }

Steps first_steps(ShootingPoint const& at) { return {at.coefficients.unaryExpr(&first_step), at.starts.unaryExpr(&first_step)}; }

/// The point, its slopes per unit of each unknown, and what the differences say of the next perturbations.
class Differences {
 public:
  Differences(SegmentSimulation const& simulation, ShootingPoint const& at) : simulation_(simulation), steps_(first_steps(at)) {}

  /// Perturbations that show, then slopes. Residuals that are not finite stay so. probes: how often a perturbation may be mended.
  std::vector<SegmentSlopes> at(ShootingPoint const& point, int probes) {
    std::vector<SegmentSlopes> slopes;
    for (int probe = 0; probe <= probes; ++probe) {
      slopes = simulation_.slopes(point, steps_.coefficient, steps_.start);
      used_ = steps_;
      if (mend(slopes)) break;
    }
    divide(slopes);
    return slopes;
  }

 private:
  // Effects in units of the channels' sds, root mean square over what is measured. Whether all serve.
  bool mend(std::vector<SegmentSlopes> const& slopes) {
    int const k = simulation_.coefficients(), d = simulation_.states();
    bool good = true;
    auto const mend_one = [&](double& step, double effect) {
      effect /= simulation_.smooth() ? smooth_effect : rough_effect;
      if (!std::isfinite(effect)) {
        step *= 1e-3;
        good = false;
        return;
      }
      bool const serves = effect >= 1 / near_enough && effect <= near_enough;
      good = good && serves;
      if (effect > 0 || step < largest_step) step *= std::clamp(effect > 0 ? 1 / effect : 1e6, 1e-6, 1e6);
    };
    Eigen::VectorXd total = Eigen::VectorXd::Zero(k);
    double count = 0;
    for (std::size_t s = 0; s < slopes.size(); ++s) {
      if (!slopes[s].finite()) continue;
      Eigen::VectorXd squares = Eigen::VectorXd::Zero(k), own = Eigen::VectorXd::Zero(d);
      Eigen::Index const rows = simulation_.rows_of_channel(static_cast<int>(s));
      for (int c = 0; c < simulation_.channels(); ++c) {
        double const weight = 1 / (simulation_.size(c) * simulation_.size(c));
        squares += weight * slopes[s].by_coefficient.middleRows(c * rows, rows).colwise().squaredNorm().transpose();
        own += weight * slopes[s].by_start.middleRows(c * rows, rows).colwise().squaredNorm().transpose();
      }
      int const samples = simulation_.samples_of_segment(static_cast<int>(s));
      total += squares;
      count += samples;
      for (int x = 0; x < d && samples > 0; ++x)
        mend_one(steps_.start(x, static_cast<Eigen::Index>(s)), std::sqrt(own(x) / samples));
    }
    for (int j = 0; j < k; ++j) mend_one(steps_.coefficient(j), std::sqrt(total(j) / std::max(count, 1.0)));
    return good;
  }

  void divide(std::vector<SegmentSlopes>& slopes) const {
    for (std::size_t s = 0; s < slopes.size(); ++s) {
      for (int j = 0; j < simulation_.coefficients(); ++j) slopes[s].by_coefficient.col(j) /= used_.coefficient(j);
      for (int x = 0; x < simulation_.states(); ++x) slopes[s].by_start.col(x) /= used_.start(x, static_cast<Eigen::Index>(s));
      // A start that no perturbation moves to anything finite is taken for one that cannot be moved.
      for (int x = 0; x < simulation_.states(); ++x)
        if (!slopes[s].by_start.col(x).allFinite()) slopes[s].by_start.col(x).setZero();
    }
  }

  SegmentSimulation const& simulation_;
  Steps steps_, used_;
};

bool all_finite(std::vector<SegmentSlopes> const& slopes) {
  return std::all_of(slopes.begin(), slopes.end(),
                     [](SegmentSlopes const& each) { return each.finite() && each.by_coefficient.allFinite(); });
}

std::vector<double> squares_of(SegmentSimulation const& simulation, std::vector<SegmentSlopes> const& slopes) {
  std::vector<double> squares(static_cast<std::size_t>(simulation.channels()), 0);
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    Eigen::Index const rows = simulation.rows_of_channel(static_cast<int>(s));
    for (int c = 0; c < simulation.channels(); ++c)
      squares[static_cast<std::size_t>(c)] += slopes[s].residual.segment(c * rows, rows).squaredNorm();
  }
  return squares;
}

/// Per channel, samples less the share of `used` unknowns.
std::vector<double> noise_of(SegmentSimulation const& simulation, std::vector<double> const& squares, double used) {
  double total = 0;
  for (int c = 0; c < simulation.channels(); ++c) total += simulation.samples_of_channel(c);
  double const left = std::max(1 - used / std::max(total, 1.0), 1 / std::max(total, 1.0));
  std::vector<double> sds;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const n = std::max(1, simulation.samples_of_channel(c)) * left;
    sds.push_back(std::max(std::sqrt(squares[static_cast<std::size_t>(c)] / n), least_noise * simulation.size(c)));
  }
  return sds;
}

double log_likelihood_of(SegmentSimulation const& simulation, std::vector<double> const& squares) {
  std::vector<double> const sds = noise_of(simulation, squares, 0);
  double sum = 0;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const sd = sds[static_cast<std::size_t>(c)], n = simulation.samples_of_channel(c);
    if (n == 0) continue;
    sum -= n / 2 * elementary::log(2 * std::numbers::pi * sd * sd) + squares[static_cast<std::size_t>(c)] / (2 * sd * sd);
  }
  return sum;
}

/// The rows of a segment divided by the noise of their channels.
SegmentSlopes weighted(SegmentSimulation const& simulation, SegmentSlopes slopes, int segment, std::span<double const> noise_sd) {
  Eigen::Index const rows = simulation.rows_of_channel(segment);
  for (int c = 0; c < simulation.channels(); ++c) {
    double const weight = 1 / noise_sd[static_cast<std::size_t>(c)];
    slopes.residual.segment(c * rows, rows) *= weight;
    slopes.by_coefficient.middleRows(c * rows, rows) *= weight;
    slopes.by_start.middleRows(c * rows, rows) *= weight;
  }
  return slopes;
}

/// Starts eliminated: start = -upper^-1 (right + cross * coefficients), and rows that are left for the coefficients alone.
struct Eliminated {
  Eigen::MatrixXd upper, cross;  // [d x d], [d x k]
  Eigen::VectorXd right;         // [d]
  Eigen::MatrixXd left;          // [rows x k + 1], the last column the residual

  Eigen::VectorXd start(Eigen::VectorXd const& coefficients) const {
    return upper.triangularView<Eigen::Upper>().solve(-right - cross * coefficients);
  }
};

Eliminated eliminate(SegmentSlopes const& slopes, double damping) {
  Eigen::Index const n = slopes.residual.size(), d = slopes.by_start.cols(), k = slopes.by_coefficient.cols();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(n + d, d), others = Eigen::MatrixXd::Zero(n + d, k + 1);
  columns.topRows(n) = slopes.by_start;
  others.topLeftCorner(n, k) = slopes.by_coefficient;
  others.topRightCorner(n, 1) = slopes.residual;
  for (Eigen::Index x = 0; x < d; ++x) {
    double const norm = slopes.by_start.col(x).norm();
    columns(n + x, x) = norm > 0 ? std::sqrt(ridge + damping) * norm : 1;
  }
  Eliminated out;
  if (d == 0) {
    out.left = std::move(others);
    return out;
  }
  Eigen::HouseholderQR<Eigen::MatrixXd> const qr(columns);
  others.applyOnTheLeft(qr.householderQ().adjoint());
  out.upper = qr.matrixQR().topLeftCorner(d, d).triangularView<Eigen::Upper>();
  out.cross = others.topLeftCorner(d, k);
  out.right = others.topRightCorner(d, 1);
  out.left = others.bottomRows(n);
  return out;
}

/// All segments on the coefficients, as a triangle [k + 1 x k + 1].
struct Reduced {
  std::vector<Eliminated> segments;
  Eigen::MatrixXd triangle;
};

Eigen::MatrixXd triangle_of(Eigen::MatrixXd const& rows) {
  Eigen::Index const k = rows.cols();
  Eigen::HouseholderQR<Eigen::MatrixXd> const qr(rows);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(k, k);
  Eigen::Index const height = std::min(rows.rows(), k);
  out.topRows(height) = qr.matrixQR().topRows(height).triangularView<Eigen::Upper>();
  return out;
}

Reduced reduce(std::vector<SegmentSlopes> const& slopes, double damping) {
  Reduced out;
  Eigen::Index const k = slopes.front().by_coefficient.cols();
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(k);
  out.triangle = Eigen::MatrixXd::Zero(k + 1, k + 1);
  for (SegmentSlopes const& each : slopes) {
    out.segments.push_back(eliminate(each, damping));
    Eigen::MatrixXd& left = out.segments.back().left;
    Eigen::MatrixXd stacked(out.triangle.rows() + left.rows(), k + 1);
    stacked << out.triangle, left;
    out.triangle = triangle_of(stacked);
    squares += each.by_coefficient.colwise().squaredNorm().transpose();
    left.resize(0, 0);
  }
  Eigen::MatrixXd damped = Eigen::MatrixXd::Zero(2 * k + 1, k + 1);
  damped.topRows(k + 1) = out.triangle;
  for (Eigen::Index j = 0; j < k; ++j) damped(k + 1 + j, j) = squares(j) > 0 ? std::sqrt(damping * squares(j)) : 1;
  if (damping > 0 || squares.size() == 0 || squares.minCoeff() == 0) out.triangle = triangle_of(damped);
  return out;
}

struct Move {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd starts;
  double gain = 0;  // of log likelihood, to first order in the residuals
};

Move move_of(std::vector<SegmentSlopes> const& slopes, Reduced const& reduced) {
  Eigen::Index const k = slopes.front().by_coefficient.cols(), d = slopes.front().by_start.cols();
  Move move;
  move.coefficients = k == 0 ? Eigen::VectorXd()
                             : Eigen::VectorXd(reduced.triangle.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(
                                   Eigen::VectorXd(-reduced.triangle.topRightCorner(k, 1))));
  move.starts.resize(d, static_cast<Eigen::Index>(slopes.size()));
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    auto const i = static_cast<Eigen::Index>(s);
    Eigen::VectorXd after = slopes[s].residual + slopes[s].by_coefficient * move.coefficients;
    if (d > 0) {
      move.starts.col(i) = reduced.segments[s].start(move.coefficients);
      after += slopes[s].by_start * move.starts.col(i);
    }
    move.gain += (slopes[s].residual.squaredNorm() - after.squaredNorm()) / 2;
  }
  return move;
}

ShootingPoint moved(ShootingPoint point, Move const& move) {
  point.coefficients += move.coefficients;
  point.starts += move.starts;
  return point;
}

double penalty(SegmentSimulation const& simulation, std::span<double const> noise_sd) {
  double total = 0, ratio = 0, starts = 0;
  for (int c = 0; c < simulation.channels(); ++c) {
    double const n = simulation.samples_of_channel(c);
    total += n;
    ratio += n * 2 * elementary::log(simulation.size(c) / noise_sd[static_cast<std::size_t>(c)]);
  }
  for (int s = 0; s < static_cast<int>(simulation.segments().size()); ++s)
    starts += elementary::log(1.0 + simulation.samples_of_segment(s));
  double const signal = total > 0 ? elementary::exp(ratio / total) : 1;
  return simulation.coefficients() / 2.0 * elementary::log(1 + total * signal) + simulation.states() / 2.0 * starts;
}

/// What is known at the optimum beside the point.
void describe(SegmentSimulation const& simulation, std::vector<SegmentSlopes> const& slopes, ShootingFit& fit) {
  Eigen::Index const k = simulation.coefficients();
  fit.finite = true;
  fit.squares = squares_of(simulation, slopes);
  fit.log_likelihood = log_likelihood_of(simulation, fit.squares);
  fit.noise_sd = noise_of(simulation, fit.squares,
                          static_cast<double>(k) + static_cast<double>(simulation.states()) * static_cast<double>(slopes.size()));
  fit.log_evidence = fit.log_likelihood - penalty(simulation, fit.noise_sd);
  std::vector<SegmentSlopes> all;
  for (std::size_t s = 0; s < slopes.size(); ++s) all.push_back(weighted(simulation, slopes[s], static_cast<int>(s), fit.noise_sd));
  Reduced const reduced = reduce(all, 0);
  for (Eliminated const& each : reduced.segments)
    fit.follows.push_back(each.upper.size() == 0 ? Eigen::MatrixXd(0, k)
                                                 : Eigen::MatrixXd(each.upper.triangularView<Eigen::Upper>().solve(-each.cross)));
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(k);
  for (SegmentSlopes const& each : all) norms += each.by_coefficient.colwise().squaredNorm().transpose();
  Eigen::MatrixXd const upper = reduced.triangle.topLeftCorner(k, k);
  for (Eigen::Index j = 0; j < k; ++j)
    fit.determined = fit.determined && std::abs(upper(j, j)) > same_columns * std::sqrt(norms(j)) && norms(j) > 0;
  if (k == 0 || !fit.determined) {
    fit.covariance = Eigen::MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  Eigen::MatrixXd const inverse = upper.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(k, k));
  fit.covariance = inverse * inverse.transpose();
}

}  // namespace

ShootingFit fit_by_shooting(SegmentSimulation const& simulation, ShootingPoint from, ShootingOptions const& options) {
  ShootingFit fit;
  fit.point = std::move(from);
  Differences differences(simulation, fit.point);
  std::vector<SegmentSlopes> slopes = differences.at(fit.point, most_probes);
  if (!all_finite(slopes)) return fit;
  double reached = log_likelihood_of(simulation, squares_of(simulation, slopes)), damping = first_damping;
  for (fit.rounds = 0; fit.rounds < options.most_rounds; ++fit.rounds) {
    if (options.interrupted && options.interrupted()) {
      fit.interrupted = true;
      return fit;
    }
    std::vector<double> const sds = noise_of(simulation, squares_of(simulation, slopes), 0);
    std::vector<SegmentSlopes> here;
    for (std::size_t s = 0; s < slopes.size(); ++s) here.push_back(weighted(simulation, slopes[s], static_cast<int>(s), sds));
    Move const move = move_of(here, reduce(here, damping));
    if (!(move.gain >= 0)) break;  // beyond what the numbers can say
    if (move.gain < options.gain) {
      if (damping <= first_damping) {
        fit.converged = true;
        break;
      }
      damping /= 10;
      continue;
    }
    ShootingPoint const trial = moved(fit.point, move);
    std::vector<SegmentSlopes> there = differences.at(trial, 1);
    double const value =
        all_finite(there) ? log_likelihood_of(simulation, squares_of(simulation, there)) : -std::numeric_limits<double>::infinity();
    if (value >= reached) {
      damping = std::max(damping / 10, least_damping);
      fit.point = trial;
      slopes = std::move(there);
      reached = value;
    } else {
      fit.converged = move.gain < rough * options.gain;
      damping = std::max(10 * damping, first_damping);
      if (fit.converged || damping > most_damping) break;
    }
  }
  describe(simulation, slopes, fit);
  return fit;
}

void fit_starts(SegmentSimulation const& simulation, ShootingPoint& point, std::span<double const> noise_sd,
                std::function<bool()> const& interrupted) {
  constexpr double enough = 1e-4;  // gain of log likelihood
  constexpr int most_rounds = 40;
  if (simulation.states() == 0) return;
  Differences differences(simulation, point);
  std::vector<SegmentSlopes> slopes = differences.at(point, most_probes);
  std::size_t const count = slopes.size();
  std::vector<double> damping(count, first_damping);
  std::vector<bool> done(count, false);
  auto const cost = [&](SegmentSlopes const& each, std::size_t s) {
    double const squares = weighted(simulation, each, static_cast<int>(s), noise_sd).residual.squaredNorm();
    return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  };
  for (std::size_t s = 0; s < count; ++s) done[s] = !slopes[s].finite();
  for (int round = 0; round < most_rounds; ++round) {
    if (interrupted && interrupted()) return;
    ShootingPoint trial = point;
    bool open = false;
    for (std::size_t s = 0; s < count; ++s) {
      if (done[s]) continue;
      SegmentSlopes const here = weighted(simulation, slopes[s], static_cast<int>(s), noise_sd);
      Eigen::VectorXd const move = eliminate(here, damping[s]).start(Eigen::VectorXd::Zero(simulation.coefficients()));
      double const gain = (here.residual.squaredNorm() - (here.residual + here.by_start * move).squaredNorm()) / 2;
      done[s] = !(gain >= enough);
      if (done[s]) continue;
      trial.starts.col(static_cast<Eigen::Index>(s)) += move;
      open = true;
    }
    if (!open) return;
    std::vector<SegmentSlopes> const there = differences.at(trial, 0);
    for (std::size_t s = 0; s < count; ++s) {
      if (done[s]) continue;
      auto const i = static_cast<Eigen::Index>(s);
      if (cost(there[s], s) <= cost(slopes[s], s)) {
        point.starts.col(i) = trial.starts.col(i);
        slopes[s] = there[s];
        damping[s] = std::max(damping[s] / 10, least_damping);
      } else {
        damping[s] = std::max(10 * damping[s], first_damping);
        done[s] = damping[s] > most_damping;
      }
    }
  }
}

}  // namespace sysid
