// Draws of a prior show whether it spans decades.
#include "inference/abc/walk.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"

namespace sysid::abc {
namespace {

/// One width cannot serve a parameter whose prior's central 90 % spans such a factor: kernels fit to the upper decades never come
/// to rest in the lower ones. A uniform prior from zero has 19, a half-normal one 31, a logarithmic one of two decades 63.
constexpr double decades = 50;

/// Draws that tell; the same for every seed, so that the coordinates are.
constexpr int draws = 1000;

std::vector<int> spanning_decades(SelectionTarget const& candidates, int model) {
  int const dimension = candidates.dimension(model);
  LaneArray theta(dimension, draws), declared(dimension, draws);
  candidates.sample_prior(model, {0, Purpose::start, 0, 1}, theta);
  candidates.constrain(model, theta, declared);
  std::vector<int> rows;
  for (int d = 0; d < dimension; ++d) {
    std::vector<double> values(declared.row(d).begin(), declared.row(d).end());
    std::sort(values.begin(), values.end());
    double const low = values[draws / 20], high = values[draws - 1 - draws / 20];
    if (candidates.parameters(model)[static_cast<std::size_t>(d)].lower >= 0 && high > decades * low) rows.push_back(d);
  }
  return rows;
}

}  // namespace

Walk::Walk(SelectionTarget const& candidates, Plan const& plan)
    : candidates_(candidates), unconstrained_(plan.coordinates == Coordinates::unconstrained) {
  for (int m = 0; m < candidates.size(); ++m)
    logarithmic_.push_back(plan.coordinates == Coordinates::natural ? spanning_decades(candidates, m) : std::vector<int>{});
}

void Walk::to_declared(int model, ConstLanes x, Lanes declared) const {
  if (unconstrained_) return candidates_.constrain(model, x, declared);
  for (int d = 0; d < x.rows(); ++d) std::copy(x.row(d).begin(), x.row(d).end(), declared.row(d).begin());
  for (int const d : logarithmic_[static_cast<std::size_t>(model)])
    for (double& value : declared.row(d)) value = elementary::exp(value);
}

void Walk::from_theta(int model, ConstLanes theta, Lanes x) const {
  if (unconstrained_) {
    for (int d = 0; d < x.rows(); ++d) std::copy(theta.row(d).begin(), theta.row(d).end(), x.row(d).begin());
    return;
  }
  candidates_.constrain(model, theta, x);
  for (int const d : logarithmic_[static_cast<std::size_t>(model)])
    for (double& value : x.row(d)) value = elementary::log(value);
}

void Walk::to_theta(int model, ConstLanes x, Lanes theta) const {
  if (unconstrained_) {
    for (int d = 0; d < x.rows(); ++d) std::copy(x.row(d).begin(), x.row(d).end(), theta.row(d).begin());
    return;
  }
  LaneArray declared(x.rows(), x.width());
  to_declared(model, x, declared);
  candidates_.unconstrain(model, declared, theta);
}

void Walk::log_prior(int model, ConstLanes x, ConstLanes theta, std::span<double> out) const {
  candidates_.log_prior(model, theta, out, unconstrained_);
  // d declared / d log declared = declared
  for (int const d : logarithmic_[static_cast<std::size_t>(model)])
    for (std::size_t w = 0; w < out.size(); ++w) out[w] += x(d, static_cast<int>(w));
}

}  // namespace sysid::abc
