// Sample by sample: sorted draws of each member, their moments, and the densities of what was measured.
#include "app/average/mixture_bands.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "criteria/mixture.hpp"
#include "diagnostics/scores.hpp"

namespace sysid {
namespace {

using Trajectories = std::vector<std::vector<double>>;

MemberQuantity const* find(MemberAlong const& member, std::string const& name) {
  // A state that a channel of its name observes is the channel.
  MemberQuantity const* found = nullptr;
  for (MemberQuantity const& each : member.quantities)
    if (each.name == name && (found == nullptr || each.channel)) found = &each;
  return found;
}

/// What is used of a member: draws that stay finite.
struct Used {
  std::size_t place = 0;  // among all members
  double weight = 0;
  UsableTrajectories draws;
};

/// Without members that have no weight or no draws; weights sum to 1.
std::vector<Used> used(std::vector<Trajectories const*> const& members, std::vector<double> const& weights) {
  std::vector<Used> out;
  double sum = 0;
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (!(weights[k] > 0)) continue;
    Used member{k, weights[k], usable_trajectories(*members[k])};
    if (member.draws.usable.empty()) continue;
    sum += weights[k];
    out.push_back(std::move(member));
  }
  for (Used& each : out) each.weight /= sum;
  return out;
}

bool predictable(std::vector<Used> const& members, std::size_t i) {
  return !members.empty() && std::ranges::all_of(members, [&](Used const& each) { return each.draws.predictable[i] != 0; });
}

std::vector<double> at(std::vector<std::vector<double> const*> const& trajectories, std::size_t i) {
  std::vector<double> values;
  for (std::vector<double> const* each : trajectories) values.push_back((*each)[i]);
  return values;
}

double variance(std::vector<double> const& values) { return values.size() > 1 ? sample_variance(values) : 0; }

/// Quantiles of the mixture; mean and sd come from the moments.
void add_quantiles(std::vector<Used> const& members, std::size_t i, Band& band) {
  if (!predictable(members, i)) {
    for (auto* column : {&band.lower, &band.upper}) column->push_back(not_a_number);
    return;
  }
  std::vector<std::vector<double>> sorted;
  for (Used const& member : members) {
    sorted.push_back(at(member.draws.usable, i));
    std::ranges::sort(sorted.back());
  }
  std::vector<MixtureDraws> draws;
  for (std::size_t k = 0; k < members.size(); ++k) draws.push_back({members[k].weight, sorted[k]});
  band.lower.push_back(mixture_quantile(draws, 0.025));
  band.upper.push_back(mixture_quantile(draws, 0.975));
}

void count(std::vector<Trajectories const*> const& members, std::vector<double> const& weights, Band& band) {
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (!(weights[k] > 0)) continue;
    auto const all = static_cast<int>(members[k]->size());
    band.draws += all;
    band.excluded += all - static_cast<int>(usable_trajectories(*members[k]).usable.size());
  }
}

/// By name in every member; empty where one has none, or in another unit.
std::vector<MemberQuantity const*> in_all(std::vector<MemberAlong> const& members, MemberQuantity const& of) {
  std::vector<MemberQuantity const*> all;
  for (MemberAlong const& member : members) {
    MemberQuantity const* const same = find(member, of.name);
    if (same == nullptr || same->channel != of.channel || same->unit != of.unit) return {};
    all.push_back(same);
  }
  return all;
}

std::vector<Trajectories const*> column(std::vector<MemberQuantity const*> const& members, Trajectories MemberQuantity::*of) {
  std::vector<Trajectories const*> all;
  for (MemberQuantity const* each : members) all.push_back(&(each->*of));
  return all;
}

std::vector<MemberMoments> moments(std::vector<Used> const& members, std::vector<Trajectories const*> const& means,
                                   std::vector<Trajectories const*> const& noises, std::size_t i) {
  std::vector<MemberMoments> all;
  for (Used const& member : members) {
    std::vector<double> const values = at(member.draws.usable, i);
    MemberMoments each{member.weight, mean(values), variance(values), 0};
    if (!noises.empty()) {
      std::vector<double> const* const first = means[member.place]->data();
      double sum = 0;
      for (std::vector<double> const* draw : member.draws.usable)
        sum += (*noises[member.place])[static_cast<std::size_t>(draw - first)][i];
      each.noise = sum / static_cast<double>(member.draws.usable.size());
    }
    all.push_back(each);
  }
  return all;
}

void add_moments(VarianceSplit const& split, Band& band) {
  band.mean.push_back(split.mean);
  band.sd.push_back(std::sqrt(split.total()));
}

void add_unknown(std::initializer_list<std::vector<double>*> columns) {
  for (std::vector<double>* column : columns) column->push_back(not_a_number);
}

PredictedQuantity averaged(std::vector<MemberQuantity const*> const& members, std::vector<double> const& weights,
                           std::size_t rows) {
  PredictedQuantity out;
  out.name = members.front()->name;
  out.unit = members.front()->unit;
  bool const channel = members.front()->channel;
  auto const values = column(members, &MemberQuantity::values), noisy = column(members, &MemberQuantity::noisy);
  auto const means = channel ? column(members, &MemberQuantity::noise_mean) : values;
  auto const noises = channel ? column(members, &MemberQuantity::noise_variance) : std::vector<Trajectories const*>();
  std::vector<Used> const of_values = used(values, weights), of_noisy = used(noisy, weights), of_means = used(means, weights);
  count(values, weights, out.response);
  if (channel) count(noisy, weights, out.noisy);
  if (of_values.empty()) return out;
  for (std::size_t i = 0; i < rows; ++i) {
    add_quantiles(of_values, i, out.response);
    if (predictable(of_values, i))
      add_moments(split_variance(moments(of_values, values, {}, i)), out.response);
    else
      add_unknown({&out.response.mean, &out.response.sd});
    VarianceParts& parts = out.variance;
    if (predictable(of_means, i)) {
      VarianceSplit const split = split_variance(moments(of_means, means, noises, i));
      if (channel) add_moments(split, out.noisy);
      parts.parameter.push_back(split.parameter);
      parts.model.push_back(split.model);
      if (channel) parts.noise.push_back(split.noise);
    } else {
      if (channel) add_unknown({&out.noisy.mean, &out.noisy.sd, &parts.noise});
      add_unknown({&parts.parameter, &parts.model});
    }
    if (channel) add_quantiles(of_noisy, i, out.noisy);
  }
  return out;
}

double score(std::vector<Score> const& scores, char const* name) {
  auto const found = std::ranges::find_if(scores, [&](Score const& each) { return each.name == name; });
  return found == scores.end() ? not_a_number : found->value;
}

AverageScores scores_of(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored, double log_score) {
  std::vector<Score> const found = scores(quantity, scored);
  return {log_score, score(found, "nmse"), score(found, "rmse"), score(found, "coverage_95")};
}

}  // namespace

std::vector<PredictedQuantity> averaged_quantities(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                                   std::size_t lead) {
  std::vector<PredictedQuantity> out;
  for (MemberQuantity const& each : members[lead].quantities) {
    if (find(members[lead], each.name) != &each) continue;
    auto const same = in_all(members, each);
    if (!same.empty()) out.push_back(averaged(same, weights, members[lead].experiment.time.size()));
  }
  return out;
}

std::vector<AveragedChannel> averaged_scores(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                             Prediction const& average) {
  std::vector<AveragedChannel> out;
  for (PredictedQuantity const& quantity : average.quantities) {
    if (quantity.measured.empty() || quantity.response.mean.empty()) continue;
    AveragedChannel channel{average.experiment, quantity.name, quantity.unit, 0, {}, {}};
    std::vector<MemberQuantity const*> same;
    for (MemberAlong const& member : members) same.push_back(find(member, quantity.name));
    std::vector<std::uint8_t> scored(average.time.size(), 0);
    std::vector<double> sums(members.size(), 0);
    double sum = 0;
    for (std::size_t i = 0; i < scored.size(); ++i) {
      std::vector<double> densities;
      for (MemberQuantity const* each : same) densities.push_back(each->log_density[i]);
      if (std::ranges::any_of(densities, [](double x) { return std::isnan(x); })) continue;
      scored[i] = 1;
      ++channel.samples;
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += densities[k];
      sum += log_mixture_density(weights, densities);
    }
    if (channel.samples == 0) continue;
    channel.average = scores_of(quantity, scored, sum / channel.samples);
    for (std::size_t k = 0; k < members.size(); ++k) {
      PredictedQuantity alone = averaged({same[k]}, {1.0}, average.time.size());
      alone.measured = quantity.measured;
      channel.members.push_back(scores_of(alone, scored, sums[k] / channel.samples));
    }
    out.push_back(std::move(channel));
  }
  return out;
}

std::vector<VarianceShares> variance_shares(Prediction const& average) {
  std::vector<VarianceShares> out;
  bool const any_scored = std::ranges::find(average.scored, 1) != average.scored.end();
  for (PredictedQuantity const& quantity : average.quantities) {
    VarianceParts const& parts = quantity.variance;
    double parameter = 0, model = 0, noise = 0;
    int rows = 0;
    for (std::size_t i = 0; i < parts.parameter.size(); ++i) {
      if ((any_scored && average.scored[i] == 0) || std::isnan(parts.parameter[i])) continue;
      ++rows;
      parameter += parts.parameter[i];
      model += parts.model[i];
      noise += parts.noise.empty() ? 0 : parts.noise[i];
    }
    double const total = parameter + model + noise;
    if (rows == 0 || total == 0) continue;
    out.push_back({average.experiment, quantity.name, quantity.unit, std::sqrt(total / rows), parameter / total, model / total,
                   noise / total});
  }
  return out;
}

}  // namespace sysid
