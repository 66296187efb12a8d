// Members against the others, on the scale of their logarithms where all are positive.
#include "diagnostics/member_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr std::size_t least_members = 5;
constexpr double by_chance = 1e-4, power_by_chance = 1e-3;  // the latter where a member is off by a power of ten, as by a unit

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

/// The members that lie farthest from the median, by falling distance.
std::vector<std::size_t> by_distance(std::vector<MemberPlace> const& places) {
  std::vector<double> means;
  for (MemberPlace const& each : places) means.push_back(each.mean);
  double const middle = upper_median(means);
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return std::fabs(places[a].mean - middle) > std::fabs(places[b].mean - middle); });
  return order;
}

double binomial(std::size_t n, std::size_t k) {
  double all = 1;
  for (std::size_t i = 0; i < k; ++i) all *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  return all;
}

/// The chance that the nearest of the first `out` members of `order` lies as far from those that remain, of all choices of so many.
/// Posterior means of others are drawn together by their population; their variances make up for it.
double chance_of(std::vector<MemberPlace> const& places, std::vector<std::size_t> const& order, std::size_t out) {
  std::vector<double> others;
  double unsure = 0;
  for (std::size_t k = out; k < order.size(); ++k) others.push_back(places[order[k]].mean), unsure += places[order[k]].variance;
  auto const n = static_cast<double>(others.size());
  double const spread = sample_variance(others) + unsure / n;
  MemberPlace const& nearest = places[order[out - 1]];
  double const t = std::fabs(nearest.mean - mean(others)) / std::sqrt(spread * (1 + 1 / n) + nearest.variance);
  if (!std::isfinite(t)) return 1;
  return boost::math::ibeta((n - 1) / 2, 0.5, (n - 1) / (n - 1 + t * t)) * binomial(order.size(), out);
}

/// The power of ten that a member is of the mean of the others, which suggests a unit; 1 where it is none.
double power_of_ten(std::vector<MemberPlace> const& places, std::vector<std::size_t> const& order, std::size_t out) {
  double sum = 0;
  for (std::size_t k = out; k < order.size(); ++k) sum += places[order[k]].declared;
  double const ratio = places[order.front()].declared * static_cast<double>(order.size() - out) / sum;
  if (!(ratio > 0)) return 1;
  double const decades = elementary::log(ratio) / elementary::log(10.0), power = std::round(decades);
  return std::fabs(decades - power) > 0.1 ? 1 : std::pow(10.0, power);
}

}  // namespace

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
    std::vector<std::size_t> const order = by_distance(places);
    // Two that are off alike hide each other.
    std::size_t out = 0;
    for (std::size_t k = 1; k <= std::max<std::size_t>(1, members.size() / 4) && out == 0; ++k)
      if (chance_of(places, order, k) < (power_of_ten(places, order, k) == 1 ? by_chance : power_by_chance)) out = k;
    if (out == 0) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = out; k < order.size(); ++k)
      low = std::min(low, places[order[k]].declared), high = std::max(high, places[order[k]].declared);
    std::vector<std::string> names, where, values;
    for (std::size_t k = 0; k < out; ++k) {
      names.push_back(space.infos()[members[order[k]]].name);
      where.push_back(places[order[k]].experiment);
      values.push_back(significant(places[order[k]].declared, 4));
    }
    std::string const& name = space.model().parameters[static_cast<std::size_t>(parameter)].name;
    std::string const unit = unit_after_number(space.infos()[members.front()].unit);
    double const power = power_of_ten(places, order, out);
    findings.push_back(
        {FindingCode::member_far_off, Severity::warning, std::move(names),
         fmt::format("`{}` of {} is {}{}, far from those of the other experiments, {} to {}{}{}: the population is wider for it",
                     name, listed(where), listed(values), unit, significant(low, 4), significant(high, 4), unit,
                     power == 1 ? "" : fmt::format(", about {} times their mean", shortest(power))),
         fmt::format("check the units, columns and set-up of {}; if its `{}` does differ, fit the others without it and compare",
                     listed(where), name)});
  }
  return findings;
}

}  // namespace sysid
