// Perturbations are adjusted until their effect lies between rounding and curvature.
#include "likelihood/segments/segment_differences.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

// What a perturbation moves the outputs by, in their sds: small against curvature, which is large where neighbours part, and large
// against rounding or against the tolerance that an adaptive solver keeps. Within the factor a slope serves.
constexpr double smooth_effect = 1e-6, rough_effect = 1e-4;
constexpr double similar_effect = 100;
constexpr double largest_step = 1e30;  // where nothing shows

double first_step(double value) { return value != 0 ? smooth_effect * std::abs(value) : smooth_effect; }

}  // namespace

SegmentDifferences::SegmentDifferences(SegmentSimulation const& simulation, ShootingPoint const& at)
    : simulation_(simulation), next_{at.coefficients.unaryExpr(&first_step), at.starts.unaryExpr(&first_step)} {}

std::vector<SegmentSlopes> SegmentDifferences::at(ShootingPoint const& point, int probes) {
  std::vector<SegmentSlopes> slopes;
  for (int probe = 0; probe <= probes; ++probe) {
    slopes = simulation_.slopes(point, next_.coefficient, next_.start);
    used_ = next_;
    if (mend(slopes)) break;
  }
  divide(slopes);
  return slopes;
}

// Effects in units of the channels' sds, root mean square over what is measured.
bool SegmentDifferences::mend(std::vector<SegmentSlopes> const& slopes) {
  int const k = simulation_.coefficients(), d = simulation_.states();
  bool good = true;
  auto const mend_one = [&](double& step, double effect) {
    effect /= simulation_.smooth() ? smooth_effect : rough_effect;
    if (!std::isfinite(effect)) {
      step *= 1e-3;
      good = false;
      return;
    }
    bool const serves = effect >= 1 / similar_effect && effect <= similar_effect;
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
    for (int x = 0; x < d && samples > 0; ++x) mend_one(next_.start(x, static_cast<Eigen::Index>(s)), std::sqrt(own(x) / samples));
  }
  for (int j = 0; j < k; ++j) mend_one(next_.coefficient(j), std::sqrt(total(j) / std::max(count, 1.0)));
  return good;
}

void SegmentDifferences::divide(std::vector<SegmentSlopes>& slopes) const {
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    for (int j = 0; j < simulation_.coefficients(); ++j) slopes[s].by_coefficient.col(j) /= used_.coefficient(j);
    for (int x = 0; x < simulation_.states(); ++x) slopes[s].by_start.col(x) /= used_.start(x, static_cast<Eigen::Index>(s));
    // A start that no perturbation moves to anything finite is taken for one that cannot be moved.
    for (int x = 0; x < simulation_.states(); ++x)
      if (!slopes[s].by_start.col(x).allFinite()) slopes[s].by_start.col(x).setZero();
  }
}

}  // namespace sysid
