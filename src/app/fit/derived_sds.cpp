// The delta method along the axes of the Laplace approximation, and what tells where it does not hold.
#include "app/fit/derived_sds.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr double short_step = 1e-3, shorter_step = 1e-3 / 16;  // sds
constexpr int points_drawn = 512;
constexpr std::uint64_t own_step = 500'000;  // of Purpose::evidence
constexpr double most_left_out = 0.5;        // of the sd: its square would grow by a quarter
constexpr double flat_length = 100;          // a flat direction is ten prior widths long, its move a tenth of one
constexpr double most_of_flat = 0.3;         // of the sd: 9 % of its square
constexpr double kink = 0.01;                // of the sd: a change of slope that matters

/// Derived quantities at points around the mode.
class DerivedAround {
 public:
  DerivedAround(FitLikelihood const& likelihood, Target const& target, Mode const& mode, Draws const& draws)
      : likelihood_(likelihood), target_(target), mode_(mode), draws_(draws) {
    auto const [values, vectors] = symmetric_eigen(covariance_of(mode));
    axes_ = vectors * values.cwiseMax(0).cwiseSqrt().asDiagonal();
  }

  Eigen::Index dimension() const { return axes_.cols(); }

  /// At these distances from the mode along the axes of the Laplace approximation, in sds: a column for each quantity.
  Eigen::MatrixXd at(std::vector<Eigen::VectorXd> const& sds) const {
    std::vector<Eigen::VectorXd> points;
    for (Eigen::VectorXd const& each : sds) points.emplace_back(theta_of(mode_) + axes_ * each);
    LaneArray const theta = to_lanes(points);
    LaneArray declared(theta.rows(), theta.width());
    target_.constrain(theta, declared);
    std::vector<std::vector<double>> values;
    for (int w = 0; w < declared.width(); ++w) {
      values.emplace_back();
      for (int p = 0; p < declared.rows(); ++p) values.back().push_back(declared(p, w));
    }
    return of_declared(std::move(values));
  }

  Eigen::MatrixXd of_declared(std::vector<std::vector<double>> values) const {
    auto const count = static_cast<Eigen::Index>(values.size());
    auto const first = static_cast<std::size_t>(draws_.parameter_count);
    FitResult result;
    result.draws.names.assign(draws_.names.begin(), draws_.names.begin() + draws_.parameter_count);
    result.draws.units.assign(draws_.units.begin(), draws_.units.begin() + draws_.parameter_count);
    result.draws.parameter_count = draws_.parameter_count;
    result.draws.chains.push_back({std::move(values), {}, {}, {}, {}});
    Draws const all = likelihood_.draws(result);
    Eigen::MatrixXd out(count, static_cast<Eigen::Index>(all.names.size() - first));
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index d = 0; d < out.cols(); ++d)
        out(i, d) = all.chains.front().values[static_cast<std::size_t>(i)][first + static_cast<std::size_t>(d)];
    return out;
  }

  /// Which quantities a parameter enters: values of its prior in the place of its own change them.
  std::vector<bool> read(std::size_t parameter) const {
    constexpr int tried = 8;
    LaneArray theta(target_.dimension(), tried), declared(target_.dimension(), tried);
    target_.sample_prior({0, Purpose::test, 0, 0}, theta);
    target_.constrain(theta, declared);
    std::vector<std::vector<double>> values(tried + 1, mode_.declared);
    for (std::size_t i = 0; i < tried; ++i) values[i + 1][parameter] = declared(static_cast<int>(parameter), static_cast<int>(i));
    Eigen::MatrixXd const found = of_declared(std::move(values));
    std::vector<bool> out;
    for (Eigen::Index d = 0; d < found.cols(); ++d) out.push_back(!(found.col(d).array() == found(0, d)).all());
    return out;
  }

  /// How much each quantity changes along the directions that nothing resists, at the most.
  Eigen::VectorXd along_flat(Eigen::Index quantities) const {
    std::size_t const n = mode_.declared.size();
    std::vector<std::vector<double>> values = {mode_.declared};
    for (std::size_t at = 0; at < mode_.flat.size(); at += n) {
      values.push_back(mode_.declared);
      for (std::size_t p = 0; p < n; ++p) values.back()[p] += mode_.flat[at + p];
    }
    if (values.size() == 1) return Eigen::VectorXd::Zero(quantities);
    Eigen::MatrixXd const found = of_declared(std::move(values));
    // A move out of the bounds may leave what the quantity is defined for: it is no less open for that.
    return (found.rowwise() - found.row(0))
        .unaryExpr([](double v) { return std::isfinite(v) ? std::fabs(v) : std::numeric_limits<double>::infinity(); })
        .colwise()
        .maxCoeff();
  }

 private:
  FitLikelihood const& likelihood_;
  Target const& target_;
  Mode const& mode_;
  Draws const& draws_;
  Eigen::MatrixXd axes_;
};

/// Each as a row for a point and a column for a quantity.
struct Values {
  Eigen::MatrixXd middle, above, below, closer_above, closer_below, drawn;
  std::vector<Eigen::VectorXd> points;  // that `drawn` is of
};

Values values_around(DerivedAround const& around, std::uint64_t seed) {
  Eigen::Index const n = around.dimension();
  auto const along_axes = [&](double length) {
    std::vector<Eigen::VectorXd> out;
    for (Eigen::Index k = 0; k < n; ++k) out.emplace_back(Eigen::VectorXd::Unit(n, k) * length);
    return around.at(out);
  };
  Values out{around.at({Eigen::VectorXd::Zero(n)}),
             along_axes(short_step),
             along_axes(-short_step),
             along_axes(shorter_step),
             along_axes(-shorter_step),
             {},
             {}};
  for (std::uint64_t i = 0; i < points_drawn / 2; ++i) {
    Stream stream({seed, Purpose::evidence, i, own_step});
    Eigen::VectorXd point(n);
    for (Eigen::Index k = 0; k < n; ++k) point(k) = stream.normal();
    out.points.push_back(point);
    out.points.emplace_back(-point);
  }
  out.drawn = around.at(out.points);
  return out;
}

/// Whether the slope of quantity `d` changes at the mode: the second difference over the step shrinks with the step where it is
/// smooth.
bool has_kink(Values const& values, Eigen::Index d, double size) {
  double const middle = values.middle(0, d),
               rounding = 64 * std::numeric_limits<double>::epsilon() * std::fabs(middle) / shorter_step;
  for (Eigen::Index k = 0; k < values.above.rows(); ++k) {
    double const wide = std::fabs(values.above(k, d) - 2 * middle + values.below(k, d)) / short_step;
    double const narrow = std::fabs(values.closer_above(k, d) - 2 * middle + values.closer_below(k, d)) / shorter_step;
    if (narrow > std::max(kink * size, rounding) && narrow > 0.5 * wide) return true;
  }
  return false;
}

/// Sets the sd of one quantity, or why there is none.
void add_delta_sd(Values const& values, Eigen::Index d, double along_flat, Summary& summary) {
  Eigen::VectorXd const slope = (values.above.col(d) - values.below.col(d)) / (2 * short_step);
  auto const not_finite =
      std::count_if(values.drawn.col(d).begin(), values.drawn.col(d).end(), [](double v) { return !std::isfinite(v); });
  if (!slope.allFinite() || !std::isfinite(values.middle(0, d))) {
    summary.without_sd = "it has no derivative at the optimum";
    return;
  }
  double const sd = slope.norm();
  if (flat_length * along_flat > most_of_flat * sd) {
    summary.without_sd = "it changes along a combination of parameters that the data do not determine";
    return;
  }
  if (not_finite > 0) {
    summary.without_sd =
        fmt::format("it is not a number at {} of {} points of the Laplace approximation", not_finite, points_drawn);
    return;
  }
  double left_out = 0;
  for (std::size_t i = 0; i < values.points.size(); ++i) {
    double const rest = values.drawn(static_cast<Eigen::Index>(i), d) - values.middle(0, d) - slope.dot(values.points[i]);
    left_out += rest * rest / points_drawn;
  }
  left_out = std::sqrt(left_out);
  if (has_kink(values, d, std::max(sd, left_out)))
    summary.without_sd = "it has no derivative at the optimum";
  else if (left_out > most_left_out * sd)
    summary.without_sd = "it is too far from linear in the parameters within their sds";
  else
    summary.sd = sd;
}

/// Findings after which the sds of the parameters they name are not those of the posterior, and what to say of them.
std::string what_is_wrong(Finding const& finding) {
  if (finding.code == FindingCode::at_bound) return "lies at a bound of its prior";
  if (finding.code == FindingCode::widths_not_normal && finding.severity == Severity::error)
    return "has a posterior that is not normal around the optimum";
  return "";
}

/// Why the Laplace covariance is not that of what a quantity reads; empty where it is.
std::vector<std::string> reasons_of_covariance(DerivedAround const& around, Target const& target, FitResult const& result,
                                               std::size_t quantities) {
  std::vector<std::string> reasons(quantities);
  for (Finding const& finding : result.findings) {
    if (finding.code == FindingCode::optimum_not_reached)
      for (std::string& each : reasons) each = "the search has not reached an optimum";
    std::string const wrong = what_is_wrong(finding);
    for (std::size_t p = 0; p < target.parameters().size() && !wrong.empty(); ++p) {
      std::string const& name = target.parameters()[p].name;
      if (std::find(finding.names.begin(), finding.names.end(), name) == finding.names.end()) continue;
      std::vector<bool> const read = around.read(p);
      for (std::size_t d = 0; d < quantities; ++d)
        if (read[d] && reasons[d].empty()) reasons[d] = fmt::format("it depends on `{}`, which {}", name, wrong);
    }
  }
  return reasons;
}

}  // namespace

void add_derived_sds(FitLikelihood const& likelihood, Target const& target, FitResult const& result, Draws const& draws,
                     std::uint64_t seed, std::span<Summary> summaries) {
  auto const first = static_cast<std::size_t>(draws.parameter_count);
  if (draws.total() != 1 || result.modes.empty() || summaries.size() <= first) return;
  std::span<Summary> const derived = summaries.subspan(first);
  if (likelihood.space().dimension() != target.dimension()) {
    for (Summary& each : derived) each.without_sd = "the model has coefficients that are integrated out";
    return;
  }
  DerivedAround const around(likelihood, target, result.modes.front(), draws);
  Values const values = values_around(around, seed);
  Eigen::VectorXd const along_flat = around.along_flat(values.middle.cols());
  std::vector<std::string> const reasons = reasons_of_covariance(around, target, result, derived.size());
  for (std::size_t d = 0; d < derived.size(); ++d) {
    derived[d].without_sd = reasons[d];
    if (reasons[d].empty())
      add_delta_sd(values, static_cast<Eigen::Index>(d), along_flat(static_cast<Eigen::Index>(d)), derived[d]);
  }
}

}  // namespace sysid
