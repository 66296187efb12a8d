// Starts over ever more decades, and local searches from the likeliest.
#include "search/improper/references.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/improper/free_climb.hpp"
#include "search/improper/proper_priors.hpp"
#include "search/starts.hpp"

namespace sysid::unbounded {
namespace {

constexpr double half_decades[] = {1.5, 3, 6, 10};
constexpr int draws_per_bracket = 512, rounds_per_bracket = 15;
constexpr std::size_t likeliest = 24, others = 8, kept = 4;
constexpr std::uint64_t bracket_step = 11'000'000;  // of Purpose::start

/// Widths of what the brackets draw say nothing: on a line a unit is as good as any.
Objective objective_of(Target const& target, ObjectiveKind kind, LaneArray const& draws) {
  Objective objective = make_objective(target, kind, draws);
  objective.low.setConstant(-infinity), objective.high.setConstant(infinity);
  return objective;
}

std::vector<FreeClimber> starts_of(Objective const& objective, LaneArray const& draws, Ledger& ledger,
                                   std::function<bool()> const& stop) {
  Breadth breadth{};
  breadth.likeliest = likeliest, breadth.others = others;
  std::vector<FreeClimber> starts;
  for (Climber& each : choose_starts(objective, draws, breadth, ledger, stop, nullptr))
    starts.push_back({std::move(each.theta), each.log_density});
  return starts;
}

void sort_best_first(std::vector<FreeClimber>& climbers) {
  std::stable_sort(climbers.begin(), climbers.end(),
                   [](FreeClimber const& a, FreeClimber const& b) { return a.log_density > b.log_density; });
}

/// sds of the coordinates, where curvature leaves one; longer than 10^4 conditional ones none is taken for.
Eigen::VectorXd sds_of(Eigen::MatrixXd const& curvature) {
  Eigen::Index const n = curvature.rows();
  Eigen::VectorXd const root = curvature.diagonal().cwiseMax(0.0).cwiseSqrt();
  Eigen::VectorXd const inverse_root = root.unaryExpr([](double r) { return r > 0 ? 1 / r : 0.0; });
  auto const [values, vectors] = symmetric_eigen(inverse_root.asDiagonal() * curvature * inverse_root.asDiagonal());
  Eigen::MatrixXd const inverse = vectors * values.cwiseMax(1e-8).cwiseInverse().asDiagonal() * vectors.transpose();
  Eigen::VectorXd sd(n);
  for (Eigen::Index p = 0; p < n; ++p) sd(p) = root(p) > 0 ? std::sqrt(inverse(p, p)) / root(p) : infinity;
  return sd;
}

/// Moves coordinates that the likelihood does not depend on to where the prior is highest, the others as they are: of a hierarchy
/// the mean and the spread of its members.
void follow_prior(Target const& target, std::vector<int> const& coordinates, Eigen::MatrixXd const& likelihood_curvature,
                  Eigen::VectorXd& place) {
  constexpr int sweeps = 60;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int const p : coordinates) {
      if (likelihood_curvature(p, p) > 0) continue;
      bool const on_line = target.parameters()[static_cast<std::size_t>(p)].improper == Improper::line;
      std::vector<Eigen::VectorXd> trials{place};
      for (double exponent = on_line ? -10 : -3; exponent <= (on_line ? 10 : 1); exponent += 0.25)
        for (double const sign : {1.0, -1.0}) {
          trials.push_back(place);
          trials.back()(p) += sign * elementary::exp(std::numbers::ln10 * exponent);
        }
      std::vector<double> density(trials.size());
      target.log_prior(to_lanes(trials), density, false);
      std::size_t best = 0;
      for (std::size_t i = 1; i < density.size(); ++i)
        if (density[i] > density[best]) best = i;
      place = trials[best];
    }
}

ImproperReference around(Target const& target, int coordinate, double place, double sd) {
  ImproperReference reference{ImproperReference::Kind::normal, coordinate, place, 1};
  if (target.parameters()[static_cast<std::size_t>(coordinate)].improper == Improper::half_line) {
    constexpr double decade = std::numbers::ln10;
    reference.width = std::isfinite(sd) ? std::clamp(10 * sd, decade, 10 * decade) : decade;
  } else {
    reference.width = std::isfinite(sd) ? std::max(std::fabs(place), 30 * sd) : std::fabs(place);
    if (!(reference.width > 0)) reference.width = 1;
  }
  return reference;
}

}  // namespace

References find_references(MakeReferred const& make, std::vector<int> const& coordinates, Looked const& looked, std::uint64_t seed,
                           std::function<bool()> const& stop) {
  Ledger untold;
  std::unique_ptr<Target> target;
  std::vector<FreeClimber> best;
  std::vector<ImproperReference> references;
  ObjectiveKind const kind = looked.likelihood || looked.hierarchy ? ObjectiveKind::likelihood : ObjectiveKind::posterior;
  std::uint64_t bracket = 0;
  // All of them, whatever they gain: what two brackets find alike may be a constant response, as far off as the third one is wide.
  for (double const width : half_decades) {
    references.clear();
    for (int const each : coordinates) references.push_back({ImproperReference::Kind::decades, each, 0, width});
    target = make(references);
    LaneArray draws = draw_prior(*target, {seed, Purpose::start, 0, bracket_step + bracket++}, draws_per_bracket);
    begin_without_functions(*target, draws);
    ProperPriors const proper(*target, references);
    Objective const objective = objective_of(proper, kind, draws);
    std::vector<FreeClimber> climbers = starts_of(objective, draws, untold, stop);
    for (FreeClimber& each : best) climbers.push_back({each.theta, each.log_density});
    climb_freely(objective, climbers, rounds_per_bracket, untold, stop);
    if (stop && stop()) return {};
    sort_best_first(climbers);
    climbers.resize(std::min(climbers.size(), kept));
    best = std::move(climbers);
  }
  if (best.empty()) return {};
  References found{{}, best.front().theta};
  LaneArray const draws = draw_prior(*target, {seed, Purpose::start, 0, bracket_step + bracket}, 64);
  if (looked.hierarchy) {
    Objective const likelihood = objective_of(*target, ObjectiveKind::likelihood, draws);
    follow_prior(*target, coordinates, free_slopes(likelihood, {found.place}, untold).front().curvature, found.place);
  }
  ProperPriors const proper(*target, references);
  Objective const objective =
      looked.hierarchy ? objective_of(*target, ObjectiveKind::declared_posterior, draws) : objective_of(proper, kind, draws);
  Eigen::VectorXd const sd = sds_of(free_slopes(objective, {found.place}, untold).front().curvature);
  for (int const each : coordinates) found.of_coordinates.push_back(around(*target, each, found.place(each), sd(each)));
  return found;
}

Finding no_finite_start_of_improper() {
  return {FindingCode::no_finite_start,
          Severity::error,
          {},
          "the likelihood is not finite at any start over 20 decades of the parameters with improper priors",
          "give them proper priors near values for which the model can be solved"};
}

}  // namespace sysid::unbounded
