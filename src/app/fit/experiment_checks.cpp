// Experiments one by one: modes of each alone, and members against the others.
#include "app/fit/experiment_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_experiments = 12;  // each takes a local search of its own
constexpr double far_apart = 6;               // sds: by chance alone it does not happen
constexpr double least_gain = 20;             // nats, beyond what parameters of their own would gain by chance
constexpr std::size_t least_members = 5;
constexpr double rare = 1e-4;

/// Findings by which experiments, or disturbances in their place, may differ.
bool may_disagree(FinishedFit const& fit) {
  return fit.likelihood.model().filtered() || std::ranges::any_of(fit.report.findings, [](Finding const& each) {
           return each.code == FindingCode::residuals_not_white || each.code == FindingCode::input_in_residuals ||
                  each.code == FindingCode::residual_offset || each.code == FindingCode::noise_size ||
                  each.code == FindingCode::explains_little || each.code == FindingCode::worse_than_the_mean;
         });
}

std::vector<std::size_t> shared_coordinates(ParameterSpace const& space) {
  std::vector<std::size_t> shared;
  for (std::size_t c = 0; c < space.sampled().size(); ++c)
    if (space.rows()[static_cast<std::size_t>(space.sampled()[c])].experiment < 0) shared.push_back(c);
  return shared;
}

/// Two experiments and the estimates of one parameter from them.
struct Apart {
  std::size_t coordinate = 0, one = 0, other = 0;
  double sds = 0;
};

/// For one parameter the two experiments that are farthest apart.
Apart farthest(std::vector<Mode> const& alone, std::size_t coordinate) {
  Apart most{.coordinate = coordinate};
  for (std::size_t a = 0; a < alone.size(); ++a)
    for (std::size_t b = a + 1; b < alone.size(); ++b) {
      double const width = hypotenuse(alone[a].sd[coordinate], alone[b].sd[coordinate]);
      double const sds = std::fabs(alone[a].declared[coordinate] - alone[b].declared[coordinate]) / width;
      if (std::isfinite(sds) && sds > most.sds) most = {coordinate, a, b, sds};
    }
  return most;
}

std::string value_text(Mode const& mode, std::size_t coordinate, std::string const& unit) {
  return fmt::format("{} ± {}{}", significant(mode.declared[coordinate], 5), significant(mode.sd[coordinate], 2),
                     unit_after_number(unit));
}

/// Of a member: where its draws lie, on the scale on which they are compared.
struct MemberPlace {
  std::string experiment;
  double mean = 0, variance = 0, declared = 0;
};

/// Places of the members of one parameter; on a logarithmic scale where all are positive.
std::vector<MemberPlace> places_of(ParameterSpace const& space, std::vector<std::size_t> const& members, Draws const& draws) {
  std::vector<std::vector<double>> columns;
  bool positive = true;
  for (std::size_t const c : members) {
    columns.push_back(draws.column(c));
    positive = positive && space.infos()[c].lower >= 0 && std::ranges::all_of(columns.back(), [](double v) { return v > 0; });
  }
  std::vector<MemberPlace> places;
  for (std::size_t m = 0; m < members.size(); ++m) {
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(space.sampled()[members[m]])];
    MemberPlace place{space.experiments()[static_cast<std::size_t>(row.experiment)].name};
    place.declared = mean(columns[m]);
    if (positive)
      for (double& each : columns[m]) each = elementary::log(each);
    place.mean = mean(columns[m]);
    place.variance = sample_variance(columns[m]);
    places.push_back(std::move(place));
  }
  return places;
}

/// How many sds of the others, without it, a member lies off, where that is rarer than one in ten thousand fits; else nothing.
std::optional<double> off_the_others(std::vector<MemberPlace> const& places, std::size_t which) {
  std::vector<double> others;
  for (std::size_t m = 0; m < places.size(); ++m)
    if (m != which) others.push_back(places[m].mean);
  auto const n = static_cast<double>(others.size());
  double const spread = sample_variance(others);
  double const t = std::fabs(places[which].mean - mean(others)) / std::sqrt(spread * (1 + 1 / n) + places[which].variance);
  double const freedom = n - 1;
  if (!std::isfinite(t) || !(spread > 0)) return std::nullopt;
  double const chance = boost::math::ibeta(freedom / 2, 0.5, freedom / (freedom + t * t));
  if (chance * static_cast<double>(places.size()) > rare) return std::nullopt;
  return std::fabs(places[which].mean - mean(others)) / std::sqrt(spread);
}

/// ", about 10 times their mean": a power of ten suggests a unit; empty where it is none.
std::string power_of_ten(std::vector<MemberPlace> const& places, std::size_t which) {
  double sum = 0;
  for (std::size_t m = 0; m < places.size(); ++m) sum += m == which ? 0 : places[m].declared;
  double const ratio = places[which].declared * static_cast<double>(places.size() - 1) / sum;
  if (!(ratio > 0)) return "";
  double const decades = elementary::log(ratio) / elementary::log(10.0), power = std::round(decades);
  if (power == 0 || std::fabs(decades - power) > 0.1) return "";
  return fmt::format(", about {} times their mean", shortest(std::pow(10.0, power)));
}

}  // namespace

std::string without_shared_parameters(FinishedFit const& fit) {
  if (fit.data.size() < 2) return "there is one experiment";
  if (fit.data.size() > most_experiments) return fmt::format("there are more than {} experiments", most_experiments);
  if (shared_coordinates(fit.likelihood.space()).empty()) return "no parameter is shared by the experiments";
  if (fit.objective_kind == ObjectiveKind::likelihood) return "the likelihood of one experiment need not have a maximum";
  if (!fit.likelihood.model().processes.empty()) return "the model has a Gaussian process";
  if (fit.preparation.modes.empty()) return "the search found no mode";
  if (fit.target.is_expensive() || fit.target.is_estimated()) return "the likelihood is expensive or estimated";
  return may_disagree(fit) ? "" : "the residuals do not suggest it";
}

Findings check_shared_parameters(FinishedFit& fit) {
  ParameterSpace const& space = fit.likelihood.space();
  Mode const& together = fit.preparation.modes.front();
  std::vector<Experiment> const experiments = experiments_of(fit.data);
  std::vector<Mode> alone;
  double gain = 0;
  for (std::size_t e = 0; e < experiments.size() && !fit.session.interrupted(); ++e) {
    std::vector<Experiment> one = experiments;
    for (std::size_t k = 0; k < one.size(); ++k)
      if (k != e) one[k].scored.assign(one[k].scored.size(), 0);
    auto const target = fit.likelihood.make_target(std::move(one), fit.preparation.solver, fit.session.interruptible());
    std::vector<double> gains;
    alone.push_back(refit(*target, fit.objective_kind, {together}, fit.seed, fit.extra, {}, &gains).front());
    if (!std::isfinite(alone.back().log_density)) return {};
    gain += gains.front();
  }
  std::vector<std::size_t> const shared = shared_coordinates(space);
  double const by_chance = static_cast<double>(shared.size() * (experiments.size() - 1));
  if (alone.size() < experiments.size() || gain < least_gain + by_chance) return {};
  std::vector<Apart> apart;
  for (std::size_t const c : shared)
    if (Apart const most = farthest(alone, c); most.sds > far_apart) apart.push_back(most);
  if (apart.empty()) return {};
  std::ranges::stable_sort(apart, [](Apart const& a, Apart const& b) { return a.sds > b.sds; });
  Apart const& most = apart.front();
  ParameterInfo const& info = space.infos()[most.coordinate];
  std::string const one = experiments[most.one].name, other = experiments[most.other].name;
  std::vector<std::string> names = {info.name, one, other}, more;
  for (std::size_t k = 1; k < apart.size(); ++k) more.push_back(space.infos()[apart[k].coordinate].name);
  names.insert(names.end(), more.begin(), more.end());
  return {{FindingCode::experiments_disagree, Severity::warning, std::move(names),
           fmt::format("the experiments disagree about `{}`: {} from {} alone, {} from {} alone{}", info.name,
                       value_text(alone[most.one], most.coordinate, info.unit), one,
                       value_text(alone[most.other], most.coordinate, info.unit), other,
                       more.empty() ? "" : fmt::format("; also about {}", quoted(more))),
           fmt::format(
               "check what differs between {} and {}: units, the clock, the amplitude of the motion, the set-up; if `{}` itself "
               "may differ, declare it `per experiment`",
               one, other, info.name)}};
}

Findings check_members(ParameterSpace const& space, Draws const& draws) {
  std::map<int, std::vector<std::size_t>> parameters;  // of the model, with the coordinates of their members
  for (ParameterSpace::Member const& member : space.members()) {
    auto const coordinate = static_cast<std::size_t>(member.coordinate);
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(space.sampled()[coordinate])];
    if (row.experiment >= 0) parameters[row.parameter].push_back(coordinate);
  }
  Findings findings;
  for (auto const& [parameter, members] : parameters) {
    if (members.size() < least_members || draws.total() < 2) continue;
    std::vector<MemberPlace> const places = places_of(space, members, draws);
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t m = 0; m < places.size(); ++m)
      if (auto const sds = off_the_others(places, m); sds && *sds > most) worst = m, most = *sds;
    if (most == 0) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t m = 0; m < places.size(); ++m)
      if (m != worst) low = std::min(low, places[m].declared), high = std::max(high, places[m].declared);
    std::string const& name = space.model().parameters[static_cast<std::size_t>(parameter)].name;
    std::string const unit = unit_after_number(space.infos()[members[worst]].unit);
    findings.push_back(
        {FindingCode::member_far_off,
         Severity::warning,
         {space.infos()[members[worst]].name, places[worst].experiment},
         fmt::format("`{}` of {} is {}{}, far from those of the other experiments, {} to {}{}{}: it widens the population", name,
                     places[worst].experiment, significant(places[worst].declared, 4), unit, significant(low, 4),
                     significant(high, 4), unit, power_of_ten(places, worst)),
         fmt::format(
             "check the units, columns and set-up of {}; if its `{}` does differ, fit it without this experiment and compare",
             places[worst].experiment, name)});
  }
  return findings;
}

}  // namespace sysid
