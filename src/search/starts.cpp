// Draws of the prior, the likeliest first.
#include "search/starts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr Breadth broad{2048, 96, 32, 16, 30};
/// Of a likelihood that takes a matrix decomposition each time, and tells its gradient.
constexpr Breadth narrow{64, 6, 2, 4, 100};
/// Of an equation with an unknown function in it: what is not linear are the few other parameters, and every round asks for the
/// slopes of all coefficients.
constexpr Breadth few{2048, 12, 4, 3, 100};

/// Curvature in prior widths below which a direction is drawn again.
constexpr double loose = 30;

/// Draws of the prior, moved to where a local search has ended along all that it has determined (search/global/growing_search.hpp).
class Pulled {
 public:
  Pulled(Climber const& climber, Objective const& objective) : at_(climber.theta), objective_(objective) {
    Eigen::Index const n = at_.size();
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
    if (climber.curvature.size() > 0 && climber.curvature.allFinite())
      curvature = objective.scale.asDiagonal() * climber.curvature * objective.scale.asDiagonal();
    auto [values, vectors] = symmetric_eigen(curvature);
    values_ = std::move(values);
    vectors_ = std::move(vectors);
  }

  bool is_loose() const { return values_.minCoeff() < loose; }
  Eigen::VectorXd operator()(Eigen::VectorXd const& draw) const {
    Eigen::VectorXd const away = vectors_.transpose() * (draw - at_).cwiseQuotient(objective_.scale);
    Eigen::VectorXd const kept = vectors_ * away.cwiseQuotient(values_.cwiseMax(1.0));
    return objective_.clamp(at_ + kept.cwiseProduct(objective_.scale), at_);
  }

 private:
  Eigen::VectorXd at_, values_;
  Eigen::MatrixXd vectors_;
  Objective const& objective_;
};

}  // namespace

Breadth const& breadth_of(Target const& target) {
  return target.climbs_by_gradient() ? narrow : has_coefficients(target) ? few : broad;
}

bool has_coefficients(Target const& target) {
  return std::any_of(target.parameters().begin(), target.parameters().end(),
                     [](ParameterInfo const& each) { return each.coefficient; });
}

std::uint64_t simulations_per_round(Target const& target) {
  constexpr std::uint64_t trials = 4;
  return target.climbs_by_gradient() ? 1 : 2 * static_cast<std::uint64_t>(target.dimension()) + 1 + trials;
}

LaneArray draw_prior(Target const& target, StreamKey key, int count) {
  LaneArray draws(target.dimension(), count);
  target.sample_prior(key, draws);
  return draws;
}

void begin_without_functions(Target const& target, LaneArray& draws) {
  for (int p = 0; p < target.dimension(); ++p)
    if (target.parameters()[static_cast<std::size_t>(p)].coefficient)
      for (int w = 0; w < draws.width(); ++w) draws(p, w) = 0;
}

std::vector<Climber> choose_starts(Objective const& objective, ConstLanes draws, Breadth const& breadth, Ledger& ledger,
                                   std::function<bool()> const& stop, Journal* journal) {
  std::vector<double> const density = log_density_in_blocks(objective, draws, ledger, stop, journal);
  std::vector<int> order;
  for (int w = 0; w < draws.width(); ++w)
    if (std::isfinite(density[static_cast<std::size_t>(w)])) order.push_back(w);
  std::size_t const best = std::min(breadth.likeliest, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(best), order.end(), [&](int a, int b) {
    double const fa = density[static_cast<std::size_t>(a)], fb = density[static_cast<std::size_t>(b)];
    return fa > fb || (fa == fb && a < b);
  });
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(best), order.end());
  order.resize(std::min(order.size(), best + breadth.others));
  std::vector<Climber> starts;
  for (int const w : order) starts.push_back(climber_at(column(draws, w), density[static_cast<std::size_t>(w)]));
  return starts;
}

std::vector<Climber> starts_from(Objective const& objective, std::vector<Climber> const& from, std::size_t breadth, Further further,
                                 StreamKey key, Ledger& ledger, std::function<bool()> const& stop, Journal* journal) {
  std::size_t const kept = std::min(from.size(), breadth);
  std::vector<Pulled> places;
  for (std::size_t k = 0; k < kept && further != Further::none; ++k) {
    Pulled each(from[k], objective);
    if (each.is_loose()) places.push_back(std::move(each));
  }
  std::size_t const pulled = places.empty() ? 0 : 4 * breadth;
  int const fresh = further == Further::all ? fresh_draws : 0;
  LaneArray draws = draw_prior(objective.target, key, static_cast<int>(pulled) + fresh);
  begin_without_functions(objective.target, draws);
  std::vector<Eigen::VectorXd> points;
  for (std::size_t k = 0; k < kept; ++k) points.push_back(from[k].theta);
  for (std::size_t i = 0; i < static_cast<std::size_t>(draws.width()); ++i) {
    Eigen::VectorXd const draw = column(draws, static_cast<int>(i));
    points.push_back(i < pulled ? places[i % places.size()](draw) : draw);
  }
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(points), ledger, stop, journal);
  std::size_t const sure = std::min(kept, (breadth + 1) / 2);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(density[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(a >= sure, -density[a]) < std::pair(b >= sure, -density[b]);
  });
  std::vector<Climber> starts;
  std::size_t unchanged = 0;
  for (std::size_t const i : order) {
    if (starts.size() == breadth) break;
    if (i >= kept + pulled && ++unchanged > std::max<std::size_t>(breadth / 4, 1)) continue;
    starts.push_back(climber_at(points[i], density[i]));
    if (i < kept) starts.back().hits = from[i].hits;
  }
  return starts;
}

}  // namespace sysid
