// Levenberg-Marquardt in a box, over lanes.
#include "search/settle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/box.hpp"
#include "search/laplace.hpp"
#include "search/search_step.hpp"
#include "search/stored_values.hpp"

namespace sysid {
namespace {

constexpr double widest_step = 2;  // prior widths, in one coordinate
constexpr double settling_dampings[] = {0.01, 0.1, 1, 10, 100};
constexpr std::size_t settling_count = std::size(settling_dampings);
constexpr double of_prior = 1e-3;  // prior widths: differences of the prior, whose second ones are needed

/// Offsets of the two differences of one coordinate: on both sides, or twice inwards where an end is nearer than the width.
struct Pair {
  double first, second;

  double slope(double at, double f, double s) const {
    return (second * second * (f - at) - first * first * (s - at)) / (first * second * (second - first));
  }
  double bend(double at, double f, double s) const { return 2 * ((s - at) / second - (f - at) / first) / (second - first); }
};

/// A climber on its way.
struct Settler {
  Climber& climber;
  Eigen::VectorXd z;
  Eigen::MatrixXd curvature;  // in z, of the last look; empty before the first
  double damping = 1e-2;
  bool done = false;
};

/// Where differences are taken: z + t axis for the two t of a pair.
struct Differences {
  Eigen::MatrixXd axes;  // [P x P] columns
  std::vector<Pair> pairs;
};

/// Each axis as long as it is where the box has room on both sides; else twice inwards.
Differences with_room(Box const& box, Eigen::VectorXd const& z, Eigen::MatrixXd axes) {
  Differences differences{std::move(axes), {}};
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    double ahead = infinity, behind = infinity;
    for (Eigen::Index p = 0; p < z.size(); ++p) {
      double const a = differences.axes(p, k), up = box.high()(p) - z(p), down = z(p) - box.low()(p);
      if (a == 0) continue;
      ahead = std::min(ahead, (a > 0 ? up : down) / std::fabs(a));
      behind = std::min(behind, (a > 0 ? down : up) / std::fabs(a));
    }
    double const most = std::max(ahead, behind), inwards = std::min(1.0, most / 2) * (ahead >= behind ? 1 : -1);
    differences.pairs.push_back(std::min(ahead, behind) >= 1 ? Pair{1, -1} : Pair{inwards, 2 * inwards});
  }
  return differences;
}

Differences along_parameters(Box const& box, Eigen::VectorXd const& z, double width) {
  return with_room(box, z, Eigen::MatrixXd((width * box.width()).asDiagonal()));
}

/// For a rough target: along the axes of the ellipsoid, as long as the roughness may drown what is shorter and no longer than the
/// density is normal. A step along a parameter would see little but the narrow direction. Parameters near an end go by themselves.
Differences along_axes(Box const& box, Eigen::VectorXd const& z, Eigen::MatrixXd const& curvature, double least) {
  constexpr double part = 0.2, most = 0.05;  // sds; prior widths
  Eigen::Index const n = z.size();
  Eigen::VectorXd const& w = box.width();
  Eigen::VectorXd unit(n);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index p = 0; p < n; ++p) {
    double const sd = curvature(p, p) > 0 ? 1 / std::sqrt(curvature(p, p)) : infinity;
    unit(p) = std::clamp(part * sd, least * w(p), most * w(p));
    if (z(p) - unit(p) >= box.low()(p) && z(p) + unit(p) <= box.high()(p)) inside.push_back(p);
  }
  Eigen::MatrixXd axes = unit.asDiagonal();
  if (!inside.empty()) {
    Eigen::VectorXd const u = unit(inside);
    auto const [values, vectors] = symmetric_eigen(u.asDiagonal() * curvature(inside, inside) * u.asDiagonal());
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      Eigen::VectorXd axis = u.cwiseProduct(vectors.col(k));
      double const widths = axis.cwiseQuotient(w(inside)).cwiseAbs().maxCoeff();
      axis *= std::min(values(k) > 0 ? part / std::sqrt(values(k)) : infinity, most / widths);
      axes(inside, inside[static_cast<std::size_t>(k)]) = axis;
    }
  }
  return axes.allFinite() ? with_room(box, z, std::move(axes)) : along_parameters(box, z, least);
}

/// The place itself, then those of the pairs.
void add_places(Box const& box, Eigen::VectorXd const& z, Differences const& differences, std::vector<Eigen::VectorXd>& points) {
  points.push_back(box.outside(z));
  for (std::size_t k = 0; k < differences.pairs.size(); ++k)
    for (double const by : {differences.pairs[k].first, differences.pairs[k].second})
      points.push_back(box.outside(z + by * differences.axes.col(static_cast<Eigen::Index>(k))));
}

/// The log density near a place: gradient and Gauss-Newton curvature in z. Not finite where the place has no neighbours.
struct Quadratic {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
};

/// residuals [R x L]: the columns of a place and its differences from `first` on.
Quadratic of_residuals(ConstLanes residuals, int first, Differences const& differences) {
  int const rows = residuals.rows();
  Eigen::Index const n = differences.axes.cols();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, n);
  Eigen::VectorXd centre(rows);
  for (int r = 0; r < rows; ++r) centre(r) = residuals(r, first);
  for (Eigen::Index p = 0; p < n; ++p) {
    int const a = first + 1 + 2 * static_cast<int>(p), b = a + 1;
    bool const near = rows > 0 && std::isfinite(residuals(0, a)), far = rows > 0 && std::isfinite(residuals(0, b));
    Pair const& pair = differences.pairs[static_cast<std::size_t>(p)];
    for (int r = 0; r < rows; ++r) {  // both neighbours failed: the coordinate is left alone
      if (near && far)
        jacobian(r, p) = pair.slope(centre(r), residuals(r, a), residuals(r, b));
      else if (near)
        jacobian(r, p) = (residuals(r, a) - centre(r)) / pair.first;
      else if (far)
        jacobian(r, p) = (residuals(r, b) - centre(r)) / pair.second;
    }
  }
  jacobian *= inverse(differences.axes);
  return {-jacobian.transpose() * centre, jacobian.transpose() * jacobian};
}

void add_prior_at(Objective const& objective, Box const& box, Eigen::VectorXd const& z, Quadratic& quadratic) {
  if (objective.objective_kind == ObjectiveKind::likelihood) return;
  Differences const differences = along_parameters(box, z, of_prior);
  std::vector<Eigen::VectorXd> points;
  add_places(box, z, differences, points);
  std::vector<double> const f = objective.log_prior(to_lanes(points));
  for (Eigen::Index p = 0; p < z.size(); ++p) {
    Pair const& pair = differences.pairs[static_cast<std::size_t>(p)];
    auto const at = static_cast<std::size_t>(1 + 2 * p);
    double const h = differences.axes(p, p), slope = pair.slope(f[0], f[at], f[at + 1]) / h,
                 bend = -pair.bend(f[0], f[at], f[at + 1]) / (h * h);
    if (std::isfinite(slope)) quadratic.gradient(p) += slope;
    if (std::isfinite(bend) && bend > 0) quadratic.curvature(p, p) += bend;
  }
}

/// curvatures: what is known of them beforehand, empty where nothing is.
std::vector<Quadratic> quadratics_at(Objective const& objective, Box const& box, std::vector<Eigen::VectorXd> const& places,
                                     std::vector<Eigen::MatrixXd> const& curvatures, Ledger& ledger) {
  double const least = difference_width(objective.target);
  std::vector<Differences> differences;
  std::vector<Eigen::VectorXd> points;
  for (std::size_t k = 0; k < places.size(); ++k) {
    bool const rough = objective.target.roughness() > 0 && curvatures[k].size() > 0 && curvatures[k].allFinite();
    differences.push_back(rough ? along_axes(box, places[k], curvatures[k], least) : along_parameters(box, places[k], least));
    add_places(box, places[k], differences.back(), points);
  }
  LaneArray residuals(objective.target.residual_count(), static_cast<int>(points.size()));
  objective.target.residuals(to_lanes(points), residuals, ledger);
  std::vector<Quadratic> quadratics;
  int const columns = 1 + 2 * objective.dimension();
  for (std::size_t k = 0; k < places.size(); ++k) {
    quadratics.push_back(of_residuals(residuals, static_cast<int>(k) * columns, differences[k]));
    add_prior_at(objective, box, places[k], quadratics.back());
  }
  return quadratics;
}

/// Where g's - 1/2 s'Hs is largest among the steps that leave the held coordinates as they are in `s`.
Eigen::VectorXd best_free(Eigen::MatrixXd const& h, Eigen::VectorXd const& g, Eigen::VectorXd s, std::vector<bool> const& held) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
  if (free.empty()) return s;
  Eigen::VectorXd fixed = s;
  for (Eigen::Index const i : free) fixed(i) = 0;
  Eigen::VectorXd const x = solve_symmetric(h(free, free), (g - h * fixed)(free));
  s(free) = x;
  return s;
}

/// The largest of g's - 1/2 s'Hs for low <= s <= high, which hold 0: by the coordinates that are held at an end. Each turn rises.
Eigen::VectorXd best_step(Eigen::MatrixXd const& h, Eigen::VectorXd const& g, Eigen::VectorXd const& low,
                          Eigen::VectorXd const& high) {
  Eigen::Index const n = g.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n);
  std::vector<bool> held(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) held[static_cast<std::size_t>(i)] = g(i) > 0 ? high(i) <= 0 : low(i) >= 0;
  for (Eigen::Index turn = 0; turn < 5 * n + 5; ++turn) {
    Eigen::VectorXd const move = best_free(h, g, s, held) - s;
    if (!move.allFinite()) return s;
    double part = 1;
    Eigen::Index stopped = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (move(i) == 0) continue;
      double const room = ((move(i) > 0 ? high(i) : low(i)) - s(i)) / move(i);
      if (room < part) part = room, stopped = i;
    }
    if ((g - h * s).dot(move) > 0)
      s += part * move;
    else if (stopped >= 0)
      return s;  // rounding: no direction up
    if (stopped >= 0) {
      s(stopped) = move(stopped) > 0 ? high(stopped) : low(stopped);
      held[static_cast<std::size_t>(stopped)] = true;
      continue;
    }
    Eigen::VectorXd const rest = g - h * s;
    Eigen::Index worst = -1;
    double most = 1e-12;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!held[static_cast<std::size_t>(i)]) continue;
      double const inward = s(i) >= high(i) ? -rest(i) : rest(i);
      if (low(i) < high(i) && inward * inward > most * h(i, i)) most = inward * inward / h(i, i), worst = i;
    }
    if (worst < 0) return s;
    held[static_cast<std::size_t>(worst)] = false;
  }
  return s;
}

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
  if (objective.target.has_gradient() || (stop && stop())) return;
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
  for (double const part : {0.25, 0.5, 0.75}) between.push_back(box.outside(from + part * (to - from)));
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
