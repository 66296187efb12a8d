// Derivatives of a model's target, experiment by experiment, each for what it reads: by tangents of the program where there are
// any, else by central differences.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "likelihood/model_target_part.hpp"

namespace sysid {
namespace {

LaneArray picked(ConstLanes theta, std::vector<int> const& lanes) {
  LaneArray some(theta.rows(), static_cast<int>(lanes.size()));
  for (int p = 0; p < theta.rows(); ++p)
    for (std::size_t k = 0; k < lanes.size(); ++k) some(p, static_cast<int>(k)) = theta(p, lanes[k]);
  return some;
}

void put_back(LaneArray const& some, std::vector<int> const& lanes, Lanes all) {
  for (int r = 0; r < some.rows(); ++r)
    for (std::size_t k = 0; k < lanes.size(); ++k) all(r, lanes[k]) = some(r, static_cast<int>(k));
}

/// `work` is several batches, each of which may be interrupted; done again, none may have been counted before.
void counted_whole(Ledger& ledger, auto const& work) {
  Ledger before = ledger;
  try {
    work();
  } catch (...) {
    ledger = std::move(before);
    throw;
  }
}

std::vector<ConstLanes> views_of(std::vector<LaneArray> const& arrays) { return {arrays.begin(), arrays.end()}; }

}  // namespace

DerivativeSource ModelTarget::derivatives() const {
  if (!compiled_->differentiated.empty()) return DerivativeSource::exact;
  return compiled_->gradient_by.empty() ? DerivativeSource::differences : DerivativeSource::mixed;
}

bool ModelTarget::climbs_by_gradient() const {
  return compiled_->differentiated.empty() &&
         std::ranges::all_of(parts_, [](Part const& part) { return part.likelihood.settles(); });
}

double ModelTarget::derivative_cost() const {
  double const each = derivatives() == DerivativeSource::exact ? 1 : 2;
  double lanes = 0, samples = 0;
  for (Part const& part : parts_) {
    double const of = part.residuals.schedule().last_summed();
    lanes += of * (each * static_cast<double>(part.read.coordinates.size()) + 1);
    samples += of;
  }
  return samples > 0 ? lanes / samples : 1;
}

std::vector<ModelTarget::Usable> ModelTarget::usable(std::vector<Columns> const& columns, std::vector<Run> const& runs,
                                                     int width) const {
  auto const coordinates = static_cast<std::size_t>(dimension());
  std::vector<Usable> result(static_cast<std::size_t>(width),
                             {true, std::vector<bool>(coordinates, true), std::vector<bool>(coordinates, true)});
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    std::vector<int> const& read = parts_[e].read.coordinates;
    std::size_t lane = 0;
    auto const next = [&] { return runs[e].outcome[static_cast<std::size_t>(columns[e].of_lane[lane++])].ok; };
    for (Usable& each : result) {
      each.centre = next() && each.centre;
      for (int const p : read) {
        auto const at = static_cast<std::size_t>(p);
        each.ahead[at] = next() && each.ahead[at];
        each.behind[at] = next() && each.behind[at];
      }
    }
  }
  return result;
}

void ModelTarget::see_slopes(ConstLanes theta, std::span<double const> steps, Ledger& ledger, SeeSlopes const& see) const {
  std::vector<LaneArray> moved;
  for (Part const& part : parts_) moved.push_back(moved_lanes(theta, part.read.coordinates, steps));
  std::vector<ConstLanes> const views = views_of(moved);
  std::vector<Columns> const columns = columns_of(views);
  std::vector<Run> const runs = run_residuals(columns);
  record_failures(true, columns, runs, views, ledger);
  std::vector<Usable> const usable = this->usable(columns, runs, theta.width());
  for (std::size_t e = 0; e < parts_.size(); ++e) {
    std::vector<int> const& read = parts_[e].read.coordinates;
    int const first = first_place_[e], rows = first_place_[e + 1] - first, count = static_cast<int>(read.size());
    Eigen::VectorXd centre(rows);
    Eigen::MatrixXd slopes(rows, count);
    for (int w = 0; w < theta.width(); ++w) {
      Usable const& good = usable[static_cast<std::size_t>(w)];
      if (!good.centre) continue;
      int const* const column = columns[e].of_lane.data() + static_cast<std::ptrdiff_t>(w) * (2 * count + 1);
      for (int r = 0; r < rows; ++r) {
        ResidualPlace const& place = places_[static_cast<std::size_t>(first + r)];
        auto const at = [&](bool solved, int c) { return solved ? residual(place, runs[e], column[c]) : infinity; };
        centre(r) = at(true, 0);
        for (int k = 0; k < count; ++k) {
          auto const p = static_cast<std::size_t>(read[static_cast<std::size_t>(k)]);
          slopes(r, k) = central_slope(at(good.ahead[p], 2 * k + 1), centre(r), at(good.behind[p], 2 * k + 2), steps[p]);
        }
      }
      see(static_cast<int>(e), w, centre, slopes);
    }
  }
}

void ModelTarget::residuals_with_jacobian(ConstLanes theta, Lanes out, Lanes jacobian, Ledger& ledger) const {
  for (int r = 0; r < out.rows(); ++r) std::fill(out.row(r).begin(), out.row(r).end(), infinity);
  for (int r = 0; r < jacobian.rows(); ++r) std::fill(jacobian.row(r).begin(), jacobian.row(r).end(), 0.0);
  std::vector<double> const steps = difference_steps();
  see_slopes(theta, steps, ledger, [&](int e, int w, Eigen::VectorXd const& residuals, Eigen::MatrixXd const& slopes) {
    std::vector<int> const& read = parts_[static_cast<std::size_t>(e)].read.coordinates;
    int const first = first_place_[static_cast<std::size_t>(e)];
    for (int r = 0; r < static_cast<int>(residuals.size()); ++r) {
      out(first + r, w) = residuals(r);
      for (std::size_t k = 0; k < read.size(); ++k)
        jacobian((first + r) * dimension() + read[k], w) = slopes(r, static_cast<Eigen::Index>(k));
    }
  });
}

void ModelTarget::squares_by_differences(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature,
                                         Ledger& ledger) const {
  for (Lanes const& each : {gradient, curvature})
    for (int r = 0; r < each.rows(); ++r) std::fill(each.row(r).begin(), each.row(r).end(), 0.0);
  std::vector<bool> finite(static_cast<std::size_t>(theta.width()), true);
  see_slopes(theta, steps, ledger, [&](int e, int w, Eigen::VectorXd const& residuals, Eigen::MatrixXd const& slopes) {
    std::vector<int> const& read = parts_[static_cast<std::size_t>(e)].read.coordinates;
    Eigen::VectorXd const slope = -slopes.transpose() * residuals;
    Eigen::MatrixXd const squares = slopes.transpose() * slopes;
    if (!residuals.allFinite()) finite[static_cast<std::size_t>(w)] = false;
    for (std::size_t k = 0; k < read.size(); ++k) {
      gradient(read[k], w) += slope(static_cast<Eigen::Index>(k));
      for (std::size_t l = 0; l < read.size(); ++l)
        curvature(read[k] * dimension() + read[l], w) += squares(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l));
    }
  });
  for (int w = 0; w < theta.width(); ++w)
    for (Lanes const& each : {gradient, curvature})
      for (int r = 0; r < each.rows() && !finite[static_cast<std::size_t>(w)]; ++r) each(r, w) = 0;
}

void ModelTarget::gauss_newton(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature,
                               Ledger& ledger) const {
  if (derivatives() != DerivativeSource::exact) return squares_by_differences(theta, steps, gradient, curvature, ledger);
  counted_whole(ledger, [&] {
    std::vector<int> const left = squares_by_tangents(theta, gradient, curvature, ledger);
    if (left.empty()) return;
    LaneArray const others = picked(theta, left);
    LaneArray slopes(gradient.rows(), others.width()), squares(curvature.rows(), others.width());
    squares_by_differences(others, steps, slopes, squares, ledger);
    put_back(slopes, left, gradient);
    put_back(squares, left, curvature);
  });
}

void ModelTarget::gradient_by_differences(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const {
  std::vector<double> const steps = difference_steps();
  std::vector<LaneArray> moved;
  for (Part const& part : parts_) moved.push_back(moved_lanes(theta, part.read.coordinates, steps));
  std::vector<ConstLanes> const views = views_of(moved);
  std::vector<Columns> const columns = columns_of(views);
  std::vector<Run> const runs = run_likelihood(columns);
  record_failures(false, columns, runs, views, ledger);
  std::vector<Usable> const usable = this->usable(columns, runs, theta.width());
  for (int w = 0; w < theta.width(); ++w) {
    Usable const& good = usable[static_cast<std::size_t>(w)];
    double total = 0;
    for (int p = 0; p < dimension(); ++p) gradient(p, w) = 0;
    for (std::size_t e = 0; e < parts_.size() && good.centre; ++e) {
      LaneArray const& sums = runs[e].sums;
      std::vector<int> const& read = parts_[e].read.coordinates;
      int const* const column = columns[e].of_lane.data() + static_cast<std::ptrdiff_t>(w) * (2 * std::ssize(read) + 1);
      auto const at = [&](bool solved, std::size_t c) {
        double sum = solved ? 0 : infinity;
        for (int row = 0; row < sums.rows() && solved; ++row) sum += sums(row, column[c]);
        return sum;
      };
      for (int row = 0; row < sums.rows(); ++row) total += sums(row, column[0]);  // in the order of the log likelihood
      for (std::size_t k = 0; k < read.size(); ++k) {
        auto const p = static_cast<std::size_t>(read[k]);
        gradient(read[k], w) += central_slope(at(good.ahead[p], 2 * k + 1), at(true, 0), at(good.behind[p], 2 * k + 2), steps[p]);
      }
    }
    out[static_cast<std::size_t>(w)] = good.centre && !std::isnan(total) ? total : -infinity;
  }
}

void ModelTarget::log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const {
  if (compiled_->gradient_by.empty()) return gradient_by_differences(theta, out, gradient, ledger);
  counted_whole(ledger, [&] {
    std::vector<int> const left = gradient_by_program(theta, out, gradient, ledger);
    if (!left.empty()) finish_gradients(left, theta, out, gradient, ledger);
  });
}

void ModelTarget::finish_gradients(std::vector<int> const& lanes, ConstLanes theta, std::span<double> out, Lanes gradient,
                                   Ledger& ledger) const {
  LaneArray const others = picked(theta, lanes);
  std::vector<double> values(lanes.size());
  log_likelihood(others, values, ledger);
  std::vector<int> solved;
  for (std::size_t k = 0; k < lanes.size(); ++k) {
    out[static_cast<std::size_t>(lanes[k])] = values[k];
    for (int p = 0; p < gradient.rows(); ++p) gradient(p, lanes[k]) = 0;
    if (std::isfinite(values[k])) solved.push_back(lanes[k]);
  }
  if (solved.empty()) return;
  LaneArray const rest = picked(theta, solved);
  LaneArray slopes(theta.rows(), rest.width());
  values.resize(solved.size());
  gradient_by_differences(rest, values, slopes, ledger);
  put_back(slopes, solved, gradient);
}

}  // namespace sysid
