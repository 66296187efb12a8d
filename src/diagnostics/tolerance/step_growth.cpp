// By eigenvalues, in which the units of states cancel.
#include "diagnostics/tolerance/step_growth.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"
#include "model/state_jacobian.hpp"

namespace sysid {
namespace {

constexpr int draws = 256;
constexpr double notable_growth = 1e-2;  // of the log factor by step: e^5 over 500 samples

/// Of parameters alone: at column w of [parameters x W], SI.
Eigen::MatrixXd rates_at(StateJacobian const& jacobian, LaneArray const& parameters, int w) {
  return jacobian.at([&](Node const& leaf) {
    return leaf.leaf_kind == LeafKind::parameter ? parameters(leaf.index, w) : std::numeric_limits<double>::quiet_NaN();
  });
}

/// log |R(z)| of the polynomial of exp(z) up to z^order.
double log_factor(std::complex<double> z, int order) {
  std::complex<double> value = 1;
  for (int k = order; k > 0; --k) value = 1.0 + z * value / static_cast<double>(k);
  return elementary::log(std::abs(value));
}

bool grows(Eigen::MatrixXd const& z, int order) {
  if (!z.allFinite()) return false;
  for (std::complex<double> const& each : eigenvalues(z))
    if (log_factor(each, order) > std::max(0.0, each.real()) + notable_growth) return true;
  return false;
}

double longest_step(std::vector<double> const& time) {
  double longest = 0;
  for (std::size_t i = 1; i < time.size(); ++i) longest = std::max(longest, time[i] - time[i - 1]);
  return longest;
}

bool same_lane(LaneArray const& a, LaneArray const& b, int lane) {
  for (int r = 0; r < a.rows(); ++r)
    if (!(a(r, lane) == b(r, lane))) return false;
  return true;
}

}  // namespace

double share_of_growing_steps(ParameterSpace const& space, std::vector<Experiment> const& experiments,
                              SolverSettings const& solver) {
  SolverRow const& row = solver.row();
  if (row.step == nullptr || row.order == 0) return 0;
  StateJacobian const rates(space.model());
  LaneArray theta(space.dimension(), draws);
  space.sample_prior({1, Purpose::start, 0, 0}, theta);
  LaneArray const values = space.values(theta);
  std::vector<bool> growing(draws);
  LaneArray parameters(static_cast<int>(space.model().parameters.size()), draws), before = parameters;
  double step_before = 0;
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    space.select(values, static_cast<int>(e), parameters);
    double const step = longest_step(experiments[e].time) / solver.substeps;
    for (int w = 0; w < draws; ++w) {
      auto const lane = static_cast<std::size_t>(w);
      bool const known = growing[lane] || (step <= step_before && same_lane(parameters, before, w));
      if (!known) growing[lane] = grows(step * rates_at(rates, parameters, w), row.order);
    }
    std::swap(parameters, before);
    step_before = step;
  }
  return static_cast<double>(std::ranges::count(growing, true)) / draws;
}

}  // namespace sysid
