// The marginal densities of coordinates far from the mode.
#include "search/improper/propriety.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/improper/free_climb.hpp"
#include "search/improper/repeats.hpp"
#include "search/laplace.hpp"

namespace sysid::unbounded {
namespace {

constexpr int least_half_decades = 16, most_half_decades = 40, steps_per_decade = 2;
constexpr double step_of_logarithm = std::numbers::ln10 / steps_per_decade;
constexpr double out_of_reach = 30;             // nats
constexpr double proper = 0.5, improper = 0.1;  // nats a decade
constexpr double noticeable = 3;                // nats: of a fall before the model cannot be solved any more
constexpr int rounds_per_look = 4, most_rounds = 24;
constexpr std::uint64_t scale_step = 12'000'000, rounding_step = 12'000'001;  // of Purpose::start

/// One side of one coordinate.
struct Ray {
  int coordinate;
  double sign;
  bool on_line;
  double first;                              // distance of the first place
  int last;                                  // step
  std::vector<Eigen::VectorXd> places = {};  // the mode, then one for each step
  std::vector<double> marginal = {};         // g of the steps
  double highest = -infinity;
  bool ended = false;   // fallen out of reach
  bool failed = false;  // there is no density further off

  double distance(int step) const {
    return on_line ? first * elementary::exp(step * step_of_logarithm) : first + step * step_of_logarithm;
  }
};

/// Guesses for the next place of a ray: the others as they are, as they went on so far, as powers of the distance, and along the
/// ridge that the curvature has.
std::vector<Eigen::VectorXd> guesses(Ray const& ray, Eigen::MatrixXd const& curvature, Target const& target, int step) {
  Eigen::VectorXd const& from = ray.places.back();
  auto const p = static_cast<Eigen::Index>(ray.coordinate);
  double const to = ray.places.front()(p) + ray.sign * ray.distance(step), moved = to - from(p);
  std::vector<Eigen::VectorXd> guesses(2, from);
  if (ray.places.size() > 2) {
    Eigen::VectorXd const& before = ray.places[ray.places.size() - 2];
    double const growth = moved / (from(p) - before(p));
    guesses.push_back(from + growth * (from - before));
    guesses.push_back(guesses.back());
    for (Eigen::Index j = 0; j < from.size(); ++j) {
      double const ratio = from(j) / before(j);
      if (target.parameters()[static_cast<std::size_t>(j)].improper == Improper::line && ratio > 1e-4 && ratio < 1e4)
        guesses.back()(j) = from(j) * ratio;
      else if (ray.on_line)
        guesses.back()(j) = from(j) + (from(j) - before(j));
    }
  }
  if (curvature.size() > 0)
    for (Eigen::Index j = 0; j < from.size(); ++j)
      if (j != p && curvature(j, j) > 0) guesses[1](j) -= moved * curvature(j, p) / curvature(j, j);
  for (Eigen::VectorXd& each : guesses) each(p) = to;
  return guesses;
}

/// 1/2 sum log of the curvatures' inverses over all coordinates but one; a direction without any has the same width everywhere.
double log_volume(Eigen::MatrixXd const& curvature, Eigen::Index without) {
  Eigen::Index const n = curvature.rows();
  Eigen::VectorXd root = curvature.diagonal().cwiseMax(0.0).cwiseSqrt();
  root(without) = 0;
  double sum = 0;
  std::vector<Eigen::Index> bent;
  for (Eigen::Index j = 0; j < n; ++j)
    if (root(j) > 0) bent.push_back(j), sum -= elementary::log(root(j));
  auto const m = static_cast<Eigen::Index>(bent.size());
  if (m == 0) return sum;
  Eigen::MatrixXd scaled(m, m);
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < m; ++j) {
      Eigen::Index const a = bent[static_cast<std::size_t>(i)], b = bent[static_cast<std::size_t>(j)];
      scaled(i, j) = curvature(a, b) / root(a) / root(b);
    }
  for (double const value : symmetric_eigen(scaled).values) sum -= 0.5 * elementary::log(std::max(value, 1e-12));
  return sum;
}

class Walk {
 public:
  Walk(Target const& target, Mode const& mode, std::uint64_t seed, std::function<bool()> const& stop)
      : target_(target),
        objective_(make_objective(target, ObjectiveKind::posterior, seed, scale_step)),
        mode_(theta_of(mode)),
        stop_(stop) {
    Eigen::MatrixXd const covariance = covariance_of(mode);
    for (int p = 0; p < target.dimension(); ++p) {
      Improper const kind = target.parameters()[static_cast<std::size_t>(p)].improper;
      if (kind == Improper::no) continue;
      double const sd = std::min(std::sqrt(std::max(covariance(p, p), 0.0)), objective_.scale(p));
      bool const on_line = kind == Improper::line;
      double const first = on_line ? (sd > 0 ? sd : objective_.scale(p)) : std::min(sd, step_of_logarithm);
      // Of a logarithm the way to the bound first: where both ways are as flat, that is the one to name.
      for (double const sign : {on_line ? 1.0 : -1.0, on_line ? -1.0 : 1.0}) {
        double const end = objective_.centre(p) + objective_.scale(p) - mode_(p);
        int const last = on_line ? last_step_on_line(first, mode_(p)) : last_step_of_logarithm(first, sign > 0 ? end : 0);
        rays_.push_back({p, sign, on_line, first, last, {mode_}});
      }
    }
  }

  std::vector<Ray> run() && {
    Eigen::MatrixXd const at_mode = free_slopes(objective_, {mode_}, untold_).front().curvature;
    curvature_.assign(rays_.size(), at_mode);
    for (int step = 0; step <= most_half_decades && !(stop_ && stop_()); ++step) {
      std::vector<std::size_t> open;
      for (std::size_t r = 0; r < rays_.size(); ++r)
        if (!rays_[r].ended && !rays_[r].failed && step <= rays_[r].last) open.push_back(r);
      if (open.empty()) break;
      go(open, step);
    }
    return std::move(rays_);
  }

 private:
  /// At least as far as a thousand times the value.
  static int last_step_on_line(double first, double value) {
    if (!(std::fabs(value) > 0)) return least_half_decades;
    double const decades = elementary::log(std::fabs(value) / first) / std::numbers::ln10 + 3;
    return std::clamp(static_cast<int>(std::ceil(steps_per_decade * decades)), least_half_decades, most_half_decades);
  }

  /// From a mode that lies far below what the other scales of the model suggest, as that of a spread can, 8 decades beyond these.
  static int last_step_of_logarithm(double first, double end) {
    double const steps = std::max(0.0, end - first) / step_of_logarithm;
    return std::min(least_half_decades + static_cast<int>(std::ceil(std::min(steps, 1.0 * most_half_decades))), most_half_decades);
  }

  void go(std::vector<std::size_t> const& open, int step) {
    std::vector<Eigen::VectorXd> trials;
    std::vector<std::size_t> first;
    for (std::size_t const r : open) {
      first.push_back(trials.size());
      for (Eigen::VectorXd& each : guesses(rays_[r], curvature_[r], target_, step)) trials.push_back(std::move(each));
    }
    first.push_back(trials.size());
    std::vector<double> const density = log_density_in_blocks(objective_, to_lanes(trials), untold_, stop_);
    std::vector<FreeClimber> climbers;
    for (std::size_t i = 0; i < open.size(); ++i) {
      std::size_t best = first[i];
      for (std::size_t k = first[i]; k < first[i + 1]; ++k)
        if (density[k] > density[best]) best = k;
      climbers.push_back({trials[best], density[best], rays_[open[i]].coordinate});
    }
    climb(climbers);
    std::vector<Eigen::VectorXd> places;
    for (FreeClimber const& each : climbers) places.push_back(each.theta);
    std::vector<Slope> const slopes = free_slopes(objective_, places, untold_);
    for (std::size_t i = 0; i < open.size(); ++i) {
      Ray& ray = rays_[open[i]];
      ray.failed = !std::isfinite(climbers[i].log_density);
      if (ray.failed) continue;
      curvature_[open[i]] = slopes[i].curvature;
      double g = climbers[i].log_density + log_volume(slopes[i].curvature, ray.coordinate);
      if (ray.on_line) g += elementary::log(ray.distance(step));
      ray.places.push_back(std::move(climbers[i].theta));
      ray.marginal.push_back(g);
      ray.highest = std::max(ray.highest, g);
      ray.ended = g < ray.highest - out_of_reach;
    }
  }

  /// While it gains anything.
  void climb(std::vector<FreeClimber>& climbers) {
    for (int round = 0; round < most_rounds && !(stop_ && stop_()); round += rounds_per_look) {
      std::vector<double> before;
      for (FreeClimber const& each : climbers) before.push_back(each.log_density);
      climb_freely(objective_, climbers, rounds_per_look, untold_, stop_);
      bool gained = false;
      for (std::size_t i = 0; i < climbers.size(); ++i) {
        bool const worth = climbers[i].log_density > before[i] + 0.01;
        climbers[i].done = climbers[i].done || !worth;
        gained = gained || worth;
      }
      if (!gained) return;
    }
  }

  Target const& target_;
  Objective objective_;
  Eigen::VectorXd mode_;
  std::function<bool()> const& stop_;
  std::vector<Ray> rays_;
  std::vector<Eigen::MatrixXd> curvature_;
  Ledger untold_;
};

enum class Tail { proper, improper, undecided };

Tail tail_of(Ray const& ray) {
  if (ray.ended) return Tail::proper;
  auto const fall_over_decade = [&](std::size_t from) { return ray.marginal[from - steps_per_decade] - ray.marginal[from]; };
  bool const two_decades = ray.marginal.size() > 2 * steps_per_decade;
  std::size_t const last = ray.marginal.size() - 1;
  if (ray.failed) {
    // Numbers that overflow where the density has long been flat bound nothing.
    if (two_decades && fall_over_decade(last) < improper && fall_over_decade(last - steps_per_decade) < improper)
      return Tail::improper;
    bool const fallen = !ray.marginal.empty() && ray.marginal.back() < ray.highest - noticeable;
    return fallen ? Tail::proper : Tail::undecided;
  }
  if (!two_decades) return Tail::undecided;
  double const fall = fall_over_decade(last), fall_before = fall_over_decade(last - steps_per_decade);
  if (fall > proper && fall_before > proper) return Tail::proper;
  return fall < improper && fall_before < improper ? Tail::improper : Tail::undecided;
}

/// The deepest fall of g on the way.
double barrier(Ray const& ray) {
  double highest = -infinity, deepest = 0;
  for (double const g : ray.marginal) {
    highest = std::max(highest, g);
    deepest = std::max(deepest, highest - g);
  }
  return deepest;
}

std::string number_with_unit(double value, std::string const& unit) {
  return fmt::format("{:.2g}{}", value, unit_after_number(unit));
}

/// "as `a` rises, up to 1e4 N", in declared units.
std::string direction_of(Target const& target, Ray const& ray) {
  LaneArray const theta = to_lanes({ray.places.back()});
  LaneArray declared(theta.rows(), 1);
  target.constrain(theta, declared);
  ParameterInfo const& info = target.parameters()[static_cast<std::size_t>(ray.coordinate)];
  double const value = declared(ray.coordinate, 0);
  std::string const place = number_with_unit(value, info.unit);
  bool const bounded = std::isfinite(info.lower) || std::isfinite(info.upper);
  if (bounded && ray.sign < 0)
    return fmt::format("as `{}` goes to {}", info.name,
                       number_with_unit(std::isfinite(info.lower) ? info.lower : info.upper, info.unit));
  bool const rising = ray.sign > 0 && !(std::isfinite(info.upper) && !std::isfinite(info.lower));
  return fmt::format("as `{}` {} {}", info.name, rising ? "rises, up to" : "falls, down to", place);
}

constexpr char const* help_for_improper =
    "give it a proper prior, bound it by `lower` and `upper` where the physics does, fix one of the parameters, or measure more";

/// The coordinate, and what the ray drags along: others that change by a third at least on the way.
std::vector<std::string> names_of(Target const& target, Ray const& ray) {
  std::vector<std::string> names{target.parameters()[static_cast<std::size_t>(ray.coordinate)].name};
  LaneArray const theta = to_lanes({ray.places.back(), ray.places.front()});
  LaneArray declared(theta.rows(), 2);
  target.constrain(theta, declared);
  for (int p = 0; p < declared.rows(); ++p) {
    if (p == ray.coordinate) continue;
    double const now = std::fabs(declared(p, 0)), before = std::fabs(declared(p, 1));
    if (now > 4.0 / 3 * before || before > 4.0 / 3 * now) names.push_back(target.parameters()[static_cast<std::size_t>(p)].name);
  }
  return names;
}

Finding improper_tail(Target const& target, Ray const& ray) {
  std::vector<std::string> const names = names_of(target, ray);
  std::string const beside =
      names.size() > 1 ? fmt::format(", and with it {}", listed({names.begin() + 1, names.end()})) : std::string();
  return {FindingCode::improper_posterior, Severity::error, names,
          fmt::format("the posterior is improper: {}{}, its density does not fall fast enough to have a finite integral",
                      direction_of(target, ray), beside),
          help_for_improper};
}

Finding undecided_tail(Target const& target, Ray const& ray) {
  std::string const what = ray.failed ? "the model cannot be solved" : "its density falls too slowly to decide this";
  return {FindingCode::propriety_not_checked,
          Severity::warning,
          {target.parameters()[static_cast<std::size_t>(ray.coordinate)].name},
          fmt::format("whether the posterior is proper is not known: {}, {}", direction_of(target, ray), what),
          "bound the parameter by `lower` and `upper`, or give it a proper prior"};
}

/// Whether changes in the last digit of the coordinates change the density: what is left of the residuals then is rounding. A
/// record with noise tells fewer digits, however large its offset is.
bool is_singular(Objective const& objective, Eigen::VectorXd const& mode, std::uint64_t seed) {
  constexpr int tries = 8;
  constexpr double share = 1e-15;
  std::vector<Eigen::VectorXd> places{mode};
  Stream stream({seed, Purpose::start, 0, rounding_step});
  for (int k = 0; k < tries; ++k) {
    places.push_back(mode);
    for (Eigen::Index p = 0; p < mode.size(); ++p) places.back()(p) += share * mode(p) * (2 * stream.uniform() - 1);
  }
  Ledger untold;
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(places), untold);
  return std::any_of(density.begin() + 1, density.end(), [&](double each) { return !(std::fabs(each - density.front()) < 1); });
}

}  // namespace

std::optional<Finding> unbounded_density(Target const& target, Eigen::VectorXd const& place, std::uint64_t seed) {
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, scale_step);
  if (!is_singular(objective, place, seed)) return std::nullopt;
  return Finding{
      FindingCode::improper_posterior,
      Severity::error,
      {},
      "the posterior is improper: the parameters can make the residuals zero, and its density grows without bound as the "
      "noise goes to zero",
      "measure more samples than there are parameters, or give the size of the noise a proper prior"};
}

Propriety check_propriety(Target const& target, Mode const& mode, std::uint64_t seed, std::function<bool()> const& stop) {
  Propriety result;
  std::optional<Finding> singular = unbounded_density(target, theta_of(mode), seed);
  if (singular) {
    result.failure = std::move(singular);
    return result;
  }
  std::vector<Ray> const rays = Walk(target, mode, seed, stop).run();
  if (stop && stop()) return result;
  Ray const* worst = nullptr;  // others may only follow from it
  for (Ray const& ray : rays) {
    Tail const tail = tail_of(ray);
    if (tail == Tail::improper && (worst == nullptr || barrier(ray) < barrier(*worst) - improper)) worst = &ray;
    if (tail == Tail::undecided) result.findings.push_back(undecided_tail(target, ray));
  }
  if (worst != nullptr) result.failure = improper_tail(target, *worst);
  if (result.failure) return result;
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, scale_step);
  for (Finding& each : find_repeats(objective, mode, seed, stop)) {
    if (each.severity == Severity::error) {
      result.failure = std::move(each);
      break;
    }
    result.findings.push_back(std::move(each));
  }
  return result;
}

}  // namespace sysid::unbounded
