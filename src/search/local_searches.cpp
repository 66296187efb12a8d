// Merges local searches that end at the same place.
#include "search/local_searches.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "search/search_step.hpp"
#include "search/settle.hpp"

namespace sysid {
namespace {

constexpr double near = 0.05;    // prior widths
constexpr double hopeless = 30;  // nats below the best optimum
constexpr std::size_t many_modes = 12, most_modes = 64;
constexpr double nearly_as_high = 5;  // nats below the best: of more mass than can be left out where there are many
constexpr double same_mode = 0.5;     // of the two modes' widths

constexpr int most_rounds = 60;
constexpr int patient_rounds = 300;    // along a curved valley, of searches that may end highest
constexpr double may_end_highest = 3;  // nats below the highest
constexpr std::uint64_t scale_step = 2;

double gap(Objective const& objective, Eigen::VectorXd const& a, Eigen::VectorXd const& b) {
  return (a - b).cwiseQuotient(objective.scale).cwiseAbs().maxCoeff();
}

/// Logarithm of what a mode counts for: a likelihood has no mass.
double log_weight(ObjectiveKind objective_kind, Mode const& mode) {
  return objective_kind == ObjectiveKind::likelihood ? mode.log_density : mode.log_mass;
}

void share_out(ObjectiveKind objective_kind, std::vector<Mode>& modes) {
  double heaviest = -std::numeric_limits<double>::infinity(), sum = 0;
  for (Mode const& mode : modes) heaviest = std::max(heaviest, log_weight(objective_kind, mode));
  for (Mode& mode : modes) sum += mode.share = elementary::exp(log_weight(objective_kind, mode) - heaviest);
  for (Mode& mode : modes) mode.share /= sum;
}

/// log of the largest volume that Laplace's approximation gives a mode: of ten prior widths along every axis.
double most_log_volume(Objective const& objective) {
  double sum = 0;
  for (double const scale : objective.scale)
    sum += elementary::log(scale * longest_width) + 0.5 * elementary::log(2 * std::numbers::pi);
  return sum;
}

}  // namespace

void sort_best_first(std::vector<Climber>& climbers) {
  std::stable_sort(climbers.begin(), climbers.end(),
                   [](Climber const& a, Climber const& b) { return a.log_density > b.log_density; });
}

bool in_one_basin(Objective const& objective, Climber const& a, Climber const& b) {
  return gap(objective, a.theta, b.theta) < near;
}

std::vector<Climber> distinct(Objective const& objective, std::vector<Climber> climbers) {
  sort_best_first(climbers);
  std::vector<Climber> apart;
  for (Climber& climber : climbers) {
    auto const same = [&](Climber const& better) {
      if (better.curvature.size() == 0 || !in_one_basin(objective, climber, better)) return false;
      Eigen::VectorXd const between = climber.theta - better.theta;
      return between.dot(better.curvature * between) < 1;
    };
    auto const found = std::find_if(apart.begin(), apart.end(), same);
    if (found != apart.end())
      found->hits += climber.hits;
    else
      apart.push_back(std::move(climber));
  }
  return apart;
}

namespace {

/// Where each would come to at the rate of its last rounds.
std::vector<double> reach_of(std::vector<Climber> const& climbers, std::vector<double> const& before, int as_many_again) {
  std::vector<double> reach;
  for (std::size_t k = 0; k < climbers.size(); ++k)
    reach.push_back(climbers[k].log_density + (climbers[k].done ? 0 : as_many_again * (climbers[k].log_density - before[k])));
  return reach;
}

}  // namespace

std::vector<Climber> within_reach(std::vector<Climber> climbers, std::vector<double> const& before, int as_many_again) {
  std::vector<double> const reach = reach_of(climbers, before, as_many_again);
  double best = -std::numeric_limits<double>::infinity();
  for (Climber const& each : climbers) best = std::max(best, each.log_density);
  std::vector<Climber> left;
  for (std::size_t k = 0; k < climbers.size(); ++k)
    if (reach[k] >= best - hopeless) left.push_back(std::move(climbers[k]));
  return left;
}

ClimbedTogether climb_together(Objective const& objective, std::vector<Climber> climbers, int rounds, int as_many_again,
                               Ledger& ledger, std::function<bool()> const& stop, Journal* journal) {
  std::vector<double> before;
  for (Climber const& each : climbers) before.push_back(each.log_density);
  climb(objective, climbers, rounds, ledger, stop, journal);
  std::vector<double> const reach = reach_of(climbers, before, as_many_again);
  double const highest = *std::max_element(reach.begin(), reach.end());
  return {distinct(objective, within_reach(std::move(climbers), before, as_many_again)), highest};
}

void settle_all(Objective const& objective, std::vector<Climber>& climbers,
                std::function<int(std::size_t searches)> const& affordable, Ledger& ledger, std::function<bool()> const& stop,
                Journal* journal) {
  settle(objective, climbers, std::min(settling_rounds, affordable(climbers.size())), ledger, stop, journal);
  sort_best_first(climbers);
  auto const low = std::find_if(climbers.begin(), climbers.end(), [&](Climber const& each) {
    return each.log_density < climbers.front().log_density - may_end_highest;
  });
  std::vector<Climber> highest(std::make_move_iterator(climbers.begin()), std::make_move_iterator(low));
  settle(objective, highest, std::min(patient_rounds, affordable(highest.size())), ledger, stop, journal);
  std::move(highest.begin(), highest.end(), climbers.begin());
}

bool may_be_missed(std::vector<Mode> const& modes, std::size_t searches) {
  constexpr double tolerable = 0.03, as_high = 0.01;
  constexpr int usual = 2;  // places, of a search of any size
  // Modes may be ranked by their mass: neighbours need not be the next in density, and a narrow one may be higher than the best.
  std::vector<double> heights;
  int places = 1, hits = 0, high = 0;
  for (Mode const& mode : modes) {
    heights.push_back(mode.log_density);
    if (mode.log_density > modes.front().log_density - nearly_as_high) ++high;
    if (std::fabs(modes.front().log_density - mode.log_density) < as_high) hits += mode.hits;
  }
  std::ranges::sort(heights);
  for (std::size_t m = 1; m < heights.size(); ++m)
    if (heights[m] - heights[m - 1] > as_high) ++places;
  // Places of one height are often one place and its images under a symmetry; but each has its mass.
  auto const w = static_cast<double>(std::max(places, high)), n = static_cast<double>(searches);
  return hits < 2 || (w > usual && w * (w + 1) > tolerable * n * (n - 1));
}

std::size_t next_finalists(Objective const& objective, std::vector<Mode> const& modes, std::vector<Climber> ends,
                           std::size_t finalists, std::size_t starts) {
  if (modes.empty()) return finalists;
  auto const high = [&](auto const& each) { return each.log_density > modes.front().log_density - nearly_as_high; };
  // Ends that the ellipsoids leave apart may be of one mode, and modes may be of earlier passes: both must be as many.
  auto const known = static_cast<std::size_t>(std::ranges::count_if(modes, high));
  auto const met = static_cast<std::size_t>(std::ranges::count_if(distinct(objective, std::move(ends)), high));
  return std::min(known, met) < finalists ? finalists : std::min(2 * finalists, starts);
}

void rank(ObjectiveKind objective_kind, std::vector<Mode>& modes) {
  // What is asked for is the highest point, except by chains; how much lies around it is another question.
  auto const height = [&](Mode const& m) { return objective_kind == ObjectiveKind::posterior ? m.log_mass : m.log_density; };
  std::stable_sort(modes.begin(), modes.end(), [&](Mode const& a, Mode const& b) { return height(a) > height(b); });
  share_out(objective_kind, modes);
}

std::vector<Mode> modes_of(Objective const& objective, std::vector<Climber> climbers, Ledger& ledger,
                           std::function<bool()> const& stop, Journal* journal, int laplace_steps) {
  std::vector<Mode> modes;
  for (Climber const& climber : distinct(objective, std::move(climbers))) {
    if ((stop && stop()) || modes.size() >= most_modes || !std::isfinite(climber.log_density)) break;
    double const low = modes.size() < many_modes ? hopeless : nearly_as_high;
    if (!modes.empty() && climber.log_density < modes.front().log_density - low) break;
    Eigen::MatrixXd const guess =
        climber.curvature.size() > 0 ? climber.curvature : Eigen::MatrixXd(objective.scale.cwiseAbs2().cwiseInverse().asDiagonal());
    Mode mode =
        kept_mode(journal, ledger, stop, [&] { return laplace_mode(objective, climber.theta, guess, ledger, laplace_steps); });
    mode.hits = climber.hits;
    mode.stalled = climber.stalled;
    // Widths say little where the density is flat up to a bound.
    bool const bounded = objective.objective_kind != ObjectiveKind::posterior && !objective.target.climbs_by_gradient();
    auto const same = std::find_if(modes.begin(), modes.end(), [&](Mode const& other) {
      return distance(mode, other) < same_mode ||
             (bounded && kept_answer(journal, stop, [&] { return connected(objective, mode, other); }));
    });
    if (same == modes.end()) {
      modes.push_back(std::move(mode));
    } else {
      int const hits = same->hits + mode.hits;
      if (mode.log_density > same->log_density) *same = std::move(mode);
      same->hits = hits;
    }
  }
  std::erase_if(modes, [&](Mode const& mode) { return !std::isfinite(log_weight(objective.objective_kind, mode)); });
  rank(objective.objective_kind, modes);
  return modes;
}

LocalSearches modes_from(Target const& target, ObjectiveKind objective_kind, ConstLanes starts, double least_log_mass,
                         std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop, Journal* journal) {
  Objective const objective = make_objective(target, objective_kind, seed, scale_step);
  std::vector<double> const density = log_density_in_blocks(objective, starts, ledger, stop, journal);
  std::vector<Climber> climbers;
  for (int w = 0; w < starts.width(); ++w)
    if (std::isfinite(density[static_cast<std::size_t>(w)]))
      climbers.push_back(climber_at(column(starts, w), density[static_cast<std::size_t>(w)]));
  LocalSearches result;
  for (int round = 0; round < most_rounds && !climbers.empty() && !result.given_up; round += rounds_together) {
    int const as_many_again = (most_rounds - round - rounds_together) / rounds_together;
    ClimbedTogether climbed = climb_together(objective, std::move(climbers), rounds_together, as_many_again, ledger, stop, journal);
    climbers = std::move(climbed.climbers);
    if (std::all_of(climbers.begin(), climbers.end(), [](Climber const& each) { return each.done; })) break;
    result.given_up = climbed.reach + most_log_volume(objective) < least_log_mass;
  }
  if (result.given_up)
    climbers.resize(1, climbers.front());
  else
    settle(objective, climbers, settling_rounds, ledger, stop, journal);
  result.modes = modes_of(objective, std::move(climbers), ledger, stop, journal);
  return result;
}

}  // namespace sysid
