// Levenberg-Marquardt in a box, over lanes.
#include "search/settle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "search/bounded_step.hpp"
#include "search/box.hpp"
#include "search/box_quadratic.hpp"
#include "search/laplace.hpp"
#include "search/search_step.hpp"
#include "search/stored_values.hpp"

namespace sysid {
namespace {

constexpr double widest_step = 2;  // prior widths, in one coordinate
constexpr double settling_dampings[] = {0.01, 0.1, 1, 10, 100};
constexpr std::size_t settling_count = std::size(settling_dampings);

/// A climber on its way.
struct Settler {
  Climber& climber;
  Eigen::VectorXd z;
  Eigen::MatrixXd curvature;  // in z, of the last look; empty before the first
  double damping = 1e-2;
  bool done = false;
};

/// The model in widths of the prior, damped, with the room that bounds leave.
struct Subproblem {
  Eigen::MatrixXd h;
  Eigen::VectorXd g, low, high;
};

Subproblem subproblem(Box const& box, Quadratic const& quadratic, Eigen::VectorXd const& z, double damping) {
  Eigen::VectorXd const& w = box.width();
  Subproblem sub{w.asDiagonal() * quadratic.curvature * w.asDiagonal(), quadratic.gradient.cwiseProduct(w),
                 (box.low() - z).cwiseQuotient(w).cwiseMax(-widest_step).cwiseMin(0.0),
                 (box.high() - z).cwiseQuotient(w).cwiseMin(widest_step).cwiseMax(0.0)};
  Eigen::VectorXd const diagonal = sub.h.diagonal();
  double const ridge = 1e-12 * std::max(1.0, diagonal.maxCoeff());
  for (Eigen::Index p = 0; p < diagonal.size(); ++p) sub.h(p, p) += damping * std::max(diagonal(p), 1e-8) + ridge;
  return sub;
}

/// A curvature over theta as one over z.
Eigen::MatrixXd in_box(Box const& box, Eigen::VectorXd const& theta, Eigen::MatrixXd const& curvature) {
  if (curvature.size() == 0) return curvature;
  Eigen::VectorXd const slope = box.slope(theta).cwiseInverse();
  return slope.asDiagonal() * curvature * slope.asDiagonal();
}

double gain_of(Box const& box, Quadratic const& quadratic, Eigen::VectorXd const& z) {
  constexpr double undamped = 1e-9;
  if (!quadratic.gradient.allFinite() || !quadratic.curvature.allFinite()) return infinity;
  Subproblem const sub = subproblem(box, quadratic, z, undamped);
  Eigen::VectorXd const s = best_step(sub.h, sub.g, sub.low, sub.high);
  return sub.g.dot(s) - 0.5 * s.dot(sub.h * s);
}

/// Steps of some climbers from where their densities are known.
void step(Objective const& objective, Box const& box, std::vector<Settler*> const& settlers,
          std::vector<Quadratic> const& quadratics, Ledger& ledger) {
  std::vector<Eigen::VectorXd> inner, trials;
  for (std::size_t k = 0; k < settlers.size(); ++k) {
    Eigen::VectorXd const& z = settlers[k]->z;
    for (double const factor : settling_dampings) {
      Subproblem const sub = subproblem(box, quadratics[k], z, factor * settlers[k]->damping);
      Eigen::VectorXd const move = best_step(sub.h, sub.g, sub.low, sub.high).cwiseProduct(box.width());
      inner.push_back((z + move).cwiseMax(box.low()).cwiseMin(box.high()));
      trials.push_back(box.outside(inner.back()));
    }
  }
  std::vector<double> const reached = log_density_in_blocks(objective, to_lanes(trials), ledger);
  for (std::size_t k = 0; k < settlers.size(); ++k) {
    Settler& settler = *settlers[k];
    std::size_t const first = k * settling_count;
    std::size_t best = first;
    for (std::size_t i = first; i < first + settling_count; ++i)
      if (reached[i] > reached[best]) best = i;
    if (reached[best] > settler.climber.log_density) {
      settler.z = inner[best];
      settler.climber.theta = trials[best];
      settler.climber.log_density = reached[best];
      settler.damping = std::max(1e-12, settler.damping * settling_dampings[best - first] * 0.3);
      Eigen::VectorXd const slope = box.slope(settler.climber.theta);
      settler.climber.curvature = slope.asDiagonal() * quadratics[k].curvature * slope.asDiagonal();
    } else {
      settler.damping *= 1e4;
      settler.done = settler.climber.stalled = settler.damping > 1e12;
    }
  }
}

/// One round: which have arrived, and a step of those that have not, if `stepping`.
void settle_once(Objective const& objective, Box const& box, std::vector<Settler*> const& settlers, bool stepping, Ledger& ledger) {
  Ledger looked;
  std::vector<Eigen::VectorXd> places;
  std::vector<Eigen::MatrixXd> curvatures;
  for (Settler const* settler : settlers) {
    places.push_back(settler->z);
    curvatures.push_back(settler->curvature);
  }
  std::vector<Quadratic> quadratics = quadratics_at(objective, box, places, curvatures, looked);
  std::vector<Settler*> left;
  std::vector<Quadratic> of_left;
  for (std::size_t k = 0; k < settlers.size(); ++k) {
    Settler& settler = *settlers[k];
    settler.curvature = quadratics[k].curvature;
    settler.climber.gain = gain_of(box, quadratics[k], settler.z);
    double const enough = settler.climber.done ? large_gain : small_gain;
    settler.done = !(settler.climber.gain >= enough && settler.climber.gain < infinity);
    if (settler.done) continue;
    left.push_back(&settler);
    of_left.push_back(std::move(quadratics[k]));
  }
  if (!stepping || left.empty()) return;
  for (Settler* const settler : left) settler->climber.done = settler->climber.stalled = false;
  ledger.merge(looked);
  step(objective, box, left, of_left, ledger);
}

/// Of each: damping, whether it is done, its place and, where it has one, its curvature.
std::vector<double> numbers_of(std::vector<Settler> const& settlers) {
  std::vector<double> numbers;
  for (Settler const& each : settlers) {
    numbers.insert(numbers.end(), {each.damping, each.done ? 1.0 : 0.0, each.curvature.size() > 0 ? 1.0 : 0.0});
    append(numbers, each.z);
    append(numbers, each.curvature);
  }
  return numbers;
}

void restore_settlers(ClimbingStep const& kept, std::vector<Settler>& settlers) {
  std::vector<double> const& numbers = kept.rest();
  if (numbers.empty()) return;
  std::size_t at = 0;
  auto const take = [&](Eigen::Index count) {
    if (numbers.size() - at < static_cast<std::size_t>(count)) throw checkpoint::Mismatch("its searches differ in number");
    double const* const taken = numbers.data() + at;
    at += static_cast<std::size_t>(count);
    return taken;
  };
  for (Settler& each : settlers) {
    Eigen::Index const n = each.z.size();
    double const* const head = take(3);
    each.damping = head[0];
    each.done = head[1] != 0;
    each.z = Eigen::Map<Eigen::VectorXd const>(take(n), n);
    each.curvature = head[2] != 0 ? Eigen::MatrixXd(Eigen::Map<Eigen::MatrixXd const>(take(n * n), n, n)) : Eigen::MatrixXd();
  }
  bool const fits = at == numbers.size() && std::all_of(kept.place().active.begin(), kept.place().active.end(),
                                                        [&](std::size_t k) { return k < settlers.size(); });
  if (!fits) throw checkpoint::Mismatch("its searches differ in number");
}

}  // namespace

void settle(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
            std::function<bool()> const& stop, Journal* journal) {
  if (objective.target.climbs_by_gradient() || (stop && stop())) return;
  ClimbingStep kept(journal, "settle", climbers, ledger);
  if (kept.over()) return;
  Box const box(objective);
  std::vector<Settler> settlers;
  for (Climber& climber : climbers)
    if (std::isfinite(climber.log_density))
      settlers.push_back({climber, box.inside(climber.theta), in_box(box, climber.theta, climber.curvature)});
  restore_settlers(kept, settlers);
  std::size_t const width = climbers_per_block(objective);
  for (LoopPlace place = kept.place(); place.round <= rounds;
       place = {place.round + 1, 0, {}}) {  // after the last step only a look
    bool const begun = !place.active.empty();
    for (std::size_t k = 0; !begun && k < settlers.size(); ++k)
      if (!settlers[k].done) place.active.push_back(k);
    if (place.active.empty()) break;
    for (; place.first < place.active.size(); place.first += width) {
      if (stop && stop()) return;
      kept.reached(place, [&] { return numbers_of(settlers); });
      std::vector<Settler*> block;
      for (std::size_t i = place.first; i < std::min(place.active.size(), place.first + width); ++i)
        block.push_back(&settlers[place.active[i]]);
      settle_once(objective, box, block, place.round < rounds, ledger);
    }
  }
  if (stop && stop()) return;
  kept.finish();
}

bool connected(Objective const& objective, Mode const& a, Mode const& b) {
  constexpr double tolerable = 0.1;
  Box const box(objective);
  Eigen::VectorXd const from = box.inside(theta_of(a)), to = box.inside(theta_of(b));
  std::vector<Eigen::VectorXd> between;
  // Unequal parts, multiples of the golden ratio: equal ones are the places of further modes where modes are equally far apart.
  for (double const part : {0.618, 0.236, 0.854, 0.472, 0.090, 0.708, 0.326})
    between.push_back(box.outside(from + part * (to - from)));
  Ledger looked;
  double const least = std::min(a.log_density, b.log_density) - tolerable;
  std::vector<double> const density = objective.log_density(to_lanes(between), looked);
  return std::all_of(density.begin(), density.end(), [&](double each) { return each >= least; });
}

Outlook look_ahead(Objective const& objective, Eigen::VectorXd const& theta, Eigen::MatrixXd const& curvature) {
  Box const box(objective);
  Eigen::VectorXd const z = box.inside(theta), slope = box.slope(theta);
  Ledger looked;
  Quadratic const quadratic = quadratics_at(objective, box, {z}, {in_box(box, theta, curvature)}, looked).front();
  Outlook outlook{gain_of(box, quadratic, z), 0};
  if (objective.objective_kind == ObjectiveKind::posterior) return outlook;
  for (Eigen::Index p = 0; p < z.size(); ++p) {
    double const rising = quadratic.gradient(p);  // towards high
    if (!(box.at_low(z, p) && rising < 0) && !(box.at_high(z, p) && rising > 0)) continue;
    double const flat = longest_width * objective.scale(p) * std::sqrt(2 * std::numbers::pi) * slope(p);
    outlook.log_mass -= elementary::log(std::max(std::fabs(rising), 1.0)) + elementary::log(flat);
  }
  return outlook;
}

}  // namespace sysid
