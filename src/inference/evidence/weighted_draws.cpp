// Importance sampling from a mixture that adapts.
#include "inference/evidence/weighted_draws.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/generalised_pareto.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/evidence/component.hpp"
#include "inference/evidence/walked_draws.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr double of_weight = 1e-3;  // share of a mode that is followed; all others together change little
constexpr double nearer = 0.5;      // widths: modes so near have come together
constexpr int most_parameters = 40;
constexpr int draws_per_round = 300;  // even: pairs
constexpr int most_rounds = 6;
constexpr double nearly_normal = 0.8;  // effective draws, over those that they would be if the posterior were normal
constexpr double of_several = 0.3;     // effective draws over draws: a single component that adapts would not be better
constexpr int walker_count = 64;
constexpr double largest_k = 0.7;
constexpr double another_width = 1.2;  // over the mode's, or under it: not said without walkers
constexpr double most_rows = 6e7;      // that walkers may simulate: 20,000 times 3,000
constexpr std::uint64_t first_step = 4'000'000, scale_step = 4, walk_step = 14'000'000;  // of Purpose::start

/// Each with half of the weight of normal and t.
struct WeightedComponent {
  double weight;  // draws
  Component shape;

  struct Density {
    double normal, mixed;
  };

  Density density(Eigen::VectorXd const& u) const {
    Component::LogDensity const logs = shape.log_density(u);
    double const normal = elementary::exp(logs.normal);
    return {normal, 0.5 * (normal + elementary::exp(logs.student))};
  }
};

struct Population {
  std::vector<Eigen::VectorXd> places;
  std::vector<double> log_density;
  std::vector<WeightedComponent> mixture;
  std::vector<double> weight;         // over the largest
  std::vector<double> normal_weight;  // that they would have if the posterior were the normal distributions of the modes
  double largest = 0;                 // its logarithm
};

/// Pairs mirrored at the centre of their component.
void add_round(Objective const& objective, std::vector<WeightedComponent> const& components, int pairs, std::uint64_t seed,
               int round, Population& population, Ledger& ledger) {
  std::vector<Eigen::VectorXd> places;
  std::size_t which = 0;
  double passed = components.front().weight, total = 0;
  for (WeightedComponent const& each : components) total += each.weight;
  for (int pair = 0; pair < pairs; ++pair) {
    while (which + 1 < components.size() && (pair + 0.5) / pairs * total > passed) passed += components[++which].weight;
    Component const& from = components[which].shape;
    Stream stream({seed, Purpose::start, static_cast<std::uint64_t>(pair), first_step + static_cast<std::uint64_t>(round)});
    Eigen::VectorXd const move = from.move(stream, pair % 2 == 1);
    places.push_back(from.centre + move);
    places.push_back(from.centre - move);
  }
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(places), ledger);
  population.places.insert(population.places.end(), places.begin(), places.end());
  population.log_density.insert(population.log_density.end(), density.begin(), density.end());
  for (WeightedComponent each : components) {
    each.weight *= 2 * pairs / total;
    population.mixture.push_back(std::move(each));
  }
}

/// modes: the first of the mixture are theirs.
void weigh(Population& population, std::size_t modes) {
  std::vector<double> logs;
  double of_modes = 0;
  for (std::size_t m = 0; m < modes; ++m) of_modes += population.mixture[m].weight;
  population.normal_weight.clear();
  for (std::size_t k = 0; k < population.places.size(); ++k) {
    double mixture = 0, normal = 0;
    for (std::size_t m = 0; m < population.mixture.size(); ++m) {
      WeightedComponent const& each = population.mixture[m];
      WeightedComponent::Density const density = each.density(population.places[k]);
      mixture += each.weight * density.mixed / static_cast<double>(population.places.size());
      if (m < modes) normal += each.weight * density.normal / of_modes;
    }
    population.normal_weight.push_back(mixture > 0 ? normal / mixture : 0);
    logs.push_back(mixture > 0 ? population.log_density[k] - elementary::log(mixture) : -infinity);
  }
  population.largest = *std::max_element(logs.begin(), logs.end());
  population.weight.clear();
  for (double const each : logs) population.weight.push_back(elementary::exp(each - population.largest));
}

struct Moments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// Of points with weights that do not sum to anything.
Moments moments_of(std::vector<Eigen::VectorXd> const& points, std::vector<double> const& weight) {
  double sum = 0;
  Moments moments{Eigen::VectorXd::Zero(points.front().size()), {}};
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!(weight[k] > 0)) continue;
    sum += weight[k];
    moments.mean += weight[k] * points[k];
  }
  moments.mean /= sum;
  moments.covariance = Eigen::MatrixXd::Zero(moments.mean.size(), moments.mean.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    if (weight[k] > 0) moments.covariance += weight[k] / sum * (points[k] - moments.mean) * (points[k] - moments.mean).transpose();
  return moments;
}

std::vector<double> sds_of(Moments const& moments) {
  std::vector<double> sds;
  for (Eigen::Index p = 0; p < moments.mean.size(); ++p) sds.push_back(std::sqrt(moments.covariance(p, p)));
  return sds;
}

std::size_t index_of_largest(std::vector<double> const& values) {
  return static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
}

/// Weights that stand out are cut, so that a single draw is no population (Ionides 2008).
std::vector<double> cut_weights(Population const& population) {
  double mean = 0;
  for (double const each : population.weight) mean += each / static_cast<double>(population.weight.size());
  double const most = mean * std::sqrt(static_cast<double>(population.weight.size()));
  std::vector<double> cut;
  for (double const each : population.weight) cut.push_back(std::min(each, most));
  return cut;
}

/// The next round's: where the weighted draws are.
WeightedComponent adapted(Population const& population, double weight) {
  Moments const moments = moments_of(population.places, cut_weights(population));
  // A few draws span no volume: something of the first shape is left.
  Component const& first = population.mixture.front().shape;
  return {weight, Component(moments.mean, moments.covariance + 0.01 * first.root * first.root.transpose())};
}

double sum_of(std::vector<double> const& values) {
  double sum = 0;
  for (double const each : values) sum += each;
  return sum;
}

/// The evidence against that of the normal distributions, which is known: where the posterior is normal, no chance is left.
void add_evidence(Population const& population, WeightedDraws& result) {
  double const sum = sum_of(population.weight), of_normal = sum_of(population.normal_weight);
  result.log_evidence = population.largest + elementary::log(sum / of_normal);
  double square = 0;
  for (std::size_t k = 0; k + 1 < population.weight.size(); k += 2) {
    double const off = (population.weight[k] + population.weight[k + 1]) / sum -
                       (population.normal_weight[k] + population.normal_weight[k + 1]) / of_normal;
    square += off * off;
  }
  result.error = std::sqrt(square);
}

/// Declared values as they would be if they were linear in the coordinates: of those the normal distribution has the stated sds.
std::vector<Eigen::VectorXd> linearised(Target const& target, Mode const& mode, std::vector<Eigen::VectorXd> const& places) {
  Eigen::VectorXd const centre = theta_of(mode), step = 1e-3 * covariance_of(mode).diagonal().cwiseSqrt();
  std::vector<Eigen::VectorXd> points;
  for (Eigen::Index i = 0; i < centre.size(); ++i)
    for (double const sign : {1.0, -1.0}) points.push_back(centre + sign * step(i) * Eigen::VectorXd::Unit(centre.size(), i));
  LaneArray const theta = to_lanes(points);
  LaneArray declared(theta.rows(), theta.width());
  target.constrain(theta, declared);
  Eigen::MatrixXd slope(centre.size(), centre.size());
  for (Eigen::Index i = 0; i < centre.size(); ++i)
    slope.col(i) = (column(declared, static_cast<int>(2 * i)) - column(declared, static_cast<int>(2 * i + 1))) / (2 * step(i));
  Eigen::VectorXd const at = Eigen::Map<Eigen::VectorXd const>(mode.declared.data(), centre.size());
  std::vector<Eigen::VectorXd> values;
  for (Eigen::VectorXd const& each : places) values.push_back(at + slope * (each - centre));
  return values;
}

/// Means and sds against those that the same draws would give a normal posterior.
void add_widths(Target const& target, std::vector<Mode> const& modes, Population const& population, WeightedDraws& result) {
  LaneArray const theta = to_lanes(population.places);
  LaneArray declared(theta.rows(), theta.width());
  target.constrain(theta, declared);
  std::vector<Eigen::VectorXd> values;
  for (int w = 0; w < declared.width(); ++w) values.push_back(column(declared, w));
  Moments const found = moments_of(values, population.weight);
  if (modes.size() > 1) {
    for (Eigen::Index p = 0; p < found.mean.size(); ++p) {
      result.mean.push_back(found.mean(p));
      result.sd.push_back(std::sqrt(found.covariance(p, p)));
    }
    return;
  }
  Mode const& mode = modes.front();
  Moments const normal = moments_of(linearised(target, mode, population.places), population.normal_weight);
  for (Eigen::Index p = 0; p < found.mean.size(); ++p) {
    auto const i = static_cast<std::size_t>(p);
    result.mean.push_back(mode.declared[i] + found.mean(p) - normal.mean(p));
    result.sd.push_back(mode.sd[i] * std::sqrt(found.covariance(p, p) / normal.covariance(p, p)));
  }
}

WeightedDraws summarised(Target const& target, std::vector<Mode> const& modes, Population const& population) {
  WeightedDraws result;
  result.draws = static_cast<int>(population.places.size());
  result.effective = effective_number(population.weight);
  std::vector<double> logs;
  for (double const each : population.weight) logs.push_back(each > 0 ? elementary::log(each) : -infinity);
  double const k = smooth_weights(logs, pareto_tail_length(result.draws, 1)).k;
  result.confirmed = result.tell() && k < largest_k;
  result.highest = population.places[index_of_largest(population.log_density)];
  add_evidence(population, result);
  add_widths(target, modes, population, result);
  return result;
}

bool as_wide_as(Mode const& mode, WeightedDraws const& draws) {
  for (std::size_t p = 0; p < draws.sd.size(); ++p)
    if (!(draws.sd[p] < another_width * mode.sd[p] && draws.sd[p] * another_width > mode.sd[p])) return false;
  return true;
}

/// Where the weighted draws are, each place as often as its weight says.
LaneArray first_walkers(Population const& population) {
  return marginal::resampled(to_lanes(population.places), cut_weights(population), walker_count);
}

void set_moments(Target const& target, LaneArray const& theta, std::vector<double> const& weight, WeightedDraws& result) {
  LaneArray declared(theta.rows(), theta.width());
  target.constrain(theta, declared);
  std::vector<Eigen::VectorXd> values;
  for (int w = 0; w < declared.width(); ++w) values.push_back(column(declared, w));
  Moments const found = moments_of(values, weight);
  result.mean.assign(found.mean.begin(), found.mean.end());
  result.sd = sds_of(found);
}

/// What walkers make of it.
void walk_on(Objective const& objective, Population const& population, std::uint64_t seed, Ledger& ledger,
             std::function<bool()> const& stop, WeightedDraws& result) {
  Target const& target = objective.target;
  auto const most = static_cast<std::uint64_t>(most_rows / std::max(1, target.residual_count()));
  marginal::WalkedDraws const walked =
      marginal::walked_draws(objective, first_walkers(population), most, {seed, Purpose::start, 0, walk_step}, ledger, stop);
  if (walked.empty()) return;
  result.walked = true;
  std::size_t const highest = index_of_largest(walked.log_density);
  if (walked.log_density[highest] > *std::ranges::max_element(population.log_density))
    result.highest = column(walked.theta, static_cast<int>(highest));
  result.confirmed = walked.confirmed;
  result.draws = walked.theta.width();
  result.effective = walked.effective;
  if (!walked.confirmed) {
    set_moments(target, walked.walked, std::vector<double>(static_cast<std::size_t>(walked.walked.width()), 1.0), result);
    return;
  }
  double const largest = *std::max_element(walked.log_weights.begin(), walked.log_weights.end());
  std::vector<double> weight;
  for (double const each : walked.log_weights) weight.push_back(elementary::exp(each - largest));
  set_moments(target, walked.theta, weight, result);
  result.log_evidence = largest + elementary::log(sum_of(weight) / result.draws);
  result.error = std::sqrt(std::max(0.0, 1 / result.effective - 1.0 / result.draws));
}

}  // namespace

std::vector<Mode> sampled_modes(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes,
                                std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop) {
  std::vector<Mode> of_some_weight;
  for (Mode const& mode : modes)
    if (of_some_weight.empty() || mode.share > of_weight) of_some_weight.push_back(mode);
  if (objective_kind == ObjectiveKind::posterior) return of_some_weight;
  std::vector<Mode> distinct;
  for (Mode& mode : refit(target, ObjectiveKind::posterior, of_some_weight, seed, ledger, stop)) {
    if (!std::isfinite(mode.log_density)) continue;
    bool const known =
        std::any_of(distinct.begin(), distinct.end(), [&](Mode const& other) { return distance(other, mode) < nearer; });
    if (!known) distinct.push_back(std::move(mode));
  }
  return distinct;
}

WeightedDraws weighted_draws(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger,
                             std::function<bool()> const& stop, Mode const* stated) {
  if (modes.empty() || target.dimension() == 0 || target.dimension() > most_parameters || target.is_expensive()) return {};
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, scale_step);
  double heaviest = -infinity;
  for (Mode const& mode : modes) heaviest = std::max(heaviest, mode.log_mass);
  std::vector<WeightedComponent> components;
  for (Mode const& mode : modes)
    components.push_back(
        {std::max(0.05, elementary::exp(mode.log_mass - heaviest)), Component(theta_of(mode), covariance_of(mode))});
  constexpr int pairs = draws_per_round / 2;
  Population population;
  WeightedDraws result;
  for (int round = 0; round < most_rounds && !(stop && stop()); ++round) {
    add_round(objective, round == 0 ? components : std::vector<WeightedComponent>{adapted(population, 1)}, pairs, seed, round,
              population, ledger);
    weigh(population, components.size());
    if (!std::isfinite(population.largest)) return {};
    result = summarised(target, modes, population);
    // Of a normal posterior the first round's are enough; what has adapted needs 400 for widths to 4 %.
    double const needed = round > 0          ? 4 * pairs / 1.5
                          : modes.size() > 1 ? of_several * result.draws
                                             : nearly_normal * effective_number(population.normal_weight);
    if (result.effective > needed) break;
  }
  bool const in_doubt = stated != nullptr && modes.size() == 1 && modes.front().flat.empty() &&
                        !(result.confirmed && as_wide_as(modes.front(), result) && as_wide_as(*stated, result));
  if (in_doubt && !target.is_estimated() && !(stop && stop())) walk_on(objective, population, seed, ledger, stop, result);
  return result;
}

}  // namespace sysid
