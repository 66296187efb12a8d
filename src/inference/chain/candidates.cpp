// From the coordinates of a mixture to theta, and to the densities there.
#include "inference/chain/candidates.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"

namespace sysid::metropolis {
namespace {

std::vector<double> log_slopes(Target const& target, ConstLanes theta) {
  std::vector<double> with_jacobian(static_cast<std::size_t>(theta.width())), without(with_jacobian);
  target.log_prior(theta, with_jacobian);
  target.log_prior(theta, without, false);
  for (std::size_t w = 0; w < without.size(); ++w) with_jacobian[w] -= without[w];
  return with_jacobian;
}

}  // namespace

Framed framed(Target const& target, bool declared, ConstLanes theta) {
  Framed all{LaneArray(theta.rows(), theta.width()), std::vector<double>(static_cast<std::size_t>(theta.width()))};
  if (declared) {
    target.constrain(theta, all.x);
    all.log_slope = log_slopes(target, theta);
    return all;
  }
  for (int p = 0; p < theta.rows(); ++p) std::copy(theta.row(p).begin(), theta.row(p).end(), all.x.row(p).begin());
  return all;
}

Candidates::Candidates(Target const& target, Independence const* mixture, int width)
    : target_(target),
      declared_(mixture != nullptr && mixture->declared()),
      theta_(target.dimension(), width),
      framed_{LaneArray(target.dimension(), width), std::vector<double>(static_cast<std::size_t>(width))},
      from_mixture_(static_cast<std::size_t>(width)),
      outside_(from_mixture_),
      log_prior_(static_cast<std::size_t>(width)),
      log_likelihood_(log_prior_) {}

void Candidates::place(ConstLanes instead) {
  LaneArray back;
  if (declared_) {
    back = LaneArray(theta_.rows(), theta_.width());
    target_.unconstrain(framed_.x, back);
  }
  LaneArray const& from = declared_ ? back : framed_.x;
  for (int lane = 0; lane < theta_.width(); ++lane) {
    auto const w = static_cast<std::size_t>(lane);
    if (from_mixture_[w] == 0) continue;
    for (int p = 0; p < theta_.rows() && outside_[w] == 0; ++p) outside_[w] = std::isfinite(from(p, lane)) ? 0 : 1;
    for (int p = 0; p < theta_.rows(); ++p) theta_(p, lane) = outside_[w] != 0 ? instead(p, lane) : from(p, lane);
  }
}

void Candidates::evaluate(ConstLanes instead, Ledger& ledger) {
  bool const any = std::any_of(from_mixture_.begin(), from_mixture_.end(), [](char each) { return each != 0; });
  if (any) place(instead);
  target_.log_prior(theta_, log_prior_);
  target_.log_likelihood(theta_, log_likelihood_, ledger);
  if (any && declared_) framed_.log_slope = log_slopes(target_, theta_);
  for (std::size_t w = 0; w < outside_.size(); ++w)
    if (outside_[w] != 0) log_prior_[w] = -infinity;
}

}  // namespace sysid::metropolis
