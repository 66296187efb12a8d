// Sample by sample: sorted draws of each member, their moments, and the densities of what was measured.
#include "app/average/mixture_bands.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/interrupt.hpp"
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

/// One set of trajectories of all members, and which of them stay finite.
struct Drawn {
  std::vector<Trajectories const*> all;
  std::vector<UsableTrajectories> usable;

  Drawn() = default;
  Drawn(std::vector<MemberQuantity const*> const& members, Trajectories MemberQuantity::*of) {
    for (MemberQuantity const* each : members) {
      all.push_back(&(each->*of));
      usable.push_back(usable_trajectories(each->*of));
    }
  }
  bool any(std::size_t member) const { return !usable[member].usable.empty(); }
  bool has(std::size_t member, std::size_t row) const { return any(member) && usable[member].predictable[row] != 0; }
  /// The draws of a row in order.
  std::vector<double> sorted(std::size_t member, std::size_t row) const {
    std::vector<double> values;
    for (std::vector<double> const* each : usable[member].usable) values.push_back((*each)[row]);
    std::ranges::sort(values);
    return values;
  }
};

/// Weights of the members at a row: 0 of those without a value there, the others sum to 1. Empty: members with more than a
/// negligible weight have none.
std::vector<double> weights_at(Drawn const& drawn, std::vector<double> const& weights, std::size_t row) {
  std::vector<double> out(weights.size(), 0);
  double all = 0, here = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (!drawn.any(k)) continue;
    all += weights[k];
    if (drawn.has(k, row)) here += out[k] = weights[k];
  }
  if (!(here > 0) || all - here > negligible_weight * all) return {};
  for (double& weight : out) weight /= here;
  return out;
}

std::vector<double> at(std::vector<std::vector<double> const*> const& trajectories, std::size_t i) {
  std::vector<double> values;
  for (std::vector<double> const* each : trajectories) values.push_back((*each)[i]);
  return values;
}

double variance(std::vector<double> const& values) { return values.size() > 1 ? sample_variance(values) : 0; }

void add_unknown(std::initializer_list<std::vector<double>*> columns) {
  for (std::vector<double>* column : columns) column->push_back(not_a_number);
}

void add_limits(std::vector<MixtureDraws> const& draws, Band& band) {
  band.lower.push_back(mixture_quantile(draws, 0.025));
  band.upper.push_back(mixture_quantile(draws, 0.975));
}

void add_moments(VarianceSplit const& split, Band& band) {
  band.mean.push_back(split.mean);
  band.sd.push_back(std::sqrt(split.total()));
}

/// Counts trajectories, also where each has several draws of the noise. trajectories: how many there are.
void count(Drawn const& drawn, std::size_t member, std::size_t trajectories, Band& band) {
  std::vector<double> const* const first = drawn.all[member]->data();
  auto const kept = std::ranges::count_if(drawn.usable[member].usable, [&](std::vector<double> const* each) {
    return static_cast<std::size_t>(each - first) < trajectories;
  });
  band.draws += static_cast<int>(trajectories);
  band.excluded += static_cast<int>(trajectories) - static_cast<int>(kept);
}

/// By name in every member; empty where one has none, or in a unit of another dimension.
std::vector<MemberQuantity const*> in_all(std::vector<MemberAlong> const& members, MemberQuantity const& of) {
  std::vector<MemberQuantity const*> all;
  for (MemberAlong const& member : members) {
    MemberQuantity const* const same = find(member, of.name);
    if (same == nullptr || same->channel != of.channel || !same->comparable) return {};
    all.push_back(same);
  }
  return all;
}

bool past_missing(Experiment const& experiment, std::size_t row) {
  return std::ranges::any_of(experiment.has_lags, [&](auto const& channel) { return !channel.empty() && channel[row] == 0; });
}

/// One quantity, row by row.
class AveragedQuantity {
 public:
  AveragedQuantity(std::vector<MemberQuantity const*> members, std::vector<double> const& weights)
      : members_(std::move(members)), weights_(weights), channel_(members_.front()->channel) {
    values_ = Drawn(members_, &MemberQuantity::values);
    if (channel_) {
      noisy_ = Drawn(members_, &MemberQuantity::noisy);
      means_ = Drawn(members_, &MemberQuantity::noise_mean);
    }
    out_.average.name = members_.front()->name;
    out_.average.unit = members_.front()->unit;
    out_.average.logarithmic = std::ranges::all_of(members_, &MemberQuantity::logarithmic);
    out_.members.resize(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k) {
      PredictedQuantity& alone = out_.members[k].band;
      alone.name = out_.average.name;
      alone.unit = out_.average.unit;
      alone.logarithmic = out_.average.logarithmic;
      std::size_t const trajectories = members_[k]->values.size();
      for (PredictedQuantity* each : {&alone, weights_[k] > 0 ? &out_.average : nullptr}) {
        if (each == nullptr) continue;
        count(values_, k, trajectories, each->response);
        if (channel_) count(noisy_, k, trajectories, each->noisy);
      }
      any_ = any_ || (weights_[k] > 0 && values_.any(k));
    }
  }

  /// along: the members, of which this is a quantity.
  AveragedBand run(std::vector<MemberAlong> const& along, std::size_t rows) {
    constexpr std::size_t rows_at_once = 64;
    for (std::size_t i = 0; any_ && i < rows; ++i) {
      if (i % rows_at_once == 0) stop_if_interrupted();
      add_response(i);
      add_variance(i);
      if (channel_) add_noisy(i);
      for (std::size_t k = 0; k < members_.size(); ++k)
        if (is_undefined(k, i) && !past_missing(along[k].experiment, i)) ++out_.members[k].undefined;
    }
    return std::move(out_);
  }

 private:
  Drawn const& means() const { return channel_ ? means_ : values_; }

  bool is_undefined(std::size_t member, std::size_t i) const {
    if (!values_.any(member) || values_.has(member, i)) return false;
    if (channel_ && !std::isnan(members_[member]->log_density[i])) return true;
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (values_.has(k, i)) return true;
    return false;
  }

  void add_response(std::size_t i) {
    std::vector<double> const weights = weights_at(values_, weights_, i);
    std::vector<std::vector<double>> sorted(members_.size());
    std::vector<MixtureDraws> draws;
    std::vector<MemberMoments> moments;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      bool const weighs = !weights.empty() && weights[k] > 0;
      std::vector<double> values;
      if (values_.has(k, i) && (weighs || channel_)) values = at(values_.usable[k].usable, i);
      if (channel_) out_.members[k].band.response.mean.push_back(values.empty() ? not_a_number : mean(values));
      if (!weighs) continue;
      moments.push_back({weights[k], mean(values), variance(values), 0});
      sorted[k] = std::move(values);
      std::ranges::sort(sorted[k]);
      draws.push_back({weights[k], sorted[k]});
    }
    Band& band = out_.average.response;
    if (draws.empty()) return add_unknown({&band.mean, &band.sd, &band.lower, &band.upper});
    add_limits(draws, band);
    add_moments(split_variance(moments), band);
  }

  /// Of what the noise has for its mean: its variance goes to the parts.
  void add_variance(std::size_t i) {
    std::vector<double> const weights = weights_at(means(), weights_, i);
    VarianceParts& parts = out_.average.variance;
    std::vector<MemberMoments> weighed;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      MemberMoments each;
      if (means().has(k, i)) {
        std::vector<double> const values = at(means().usable[k].usable, i);
        each = {1, mean(values), variance(values), channel_ ? noise_variance(k, i) : 0};
      }
      if (channel_) {
        if (means().has(k, i))
          add_moments(split_variance(std::vector{each}), out_.members[k].band.noisy);
        else
          add_unknown({&out_.members[k].band.noisy.mean, &out_.members[k].band.noisy.sd});
      }
      if (weights.empty() || weights[k] == 0) continue;
      each.weight = weights[k];
      weighed.push_back(each);
    }
    Band& band = out_.average.noisy;
    if (weighed.empty()) {
      add_unknown({&parts.parameter, &parts.model});
      if (channel_) add_unknown({&band.mean, &band.sd, &parts.noise});
      return;
    }
    VarianceSplit const split = split_variance(weighed);
    parts.parameter.push_back(split.parameter);
    parts.model.push_back(split.model);
    if (!channel_) return;
    parts.noise.push_back(split.noise);
    add_moments(split, band);
  }

  double noise_variance(std::size_t member, std::size_t i) const {
    std::vector<double> const* const first = means_.all[member]->data();
    double sum = 0;
    for (std::vector<double> const* draw : means_.usable[member].usable)
      sum += members_[member]->noise_variance[static_cast<std::size_t>(draw - first)][i];
    return sum / static_cast<double>(means_.usable[member].usable.size());
  }

  /// The draws of each member are sorted once, for its own limits and those of the average.
  void add_noisy(std::size_t i) {
    std::vector<double> const weights = weights_at(noisy_, weights_, i);
    std::vector<std::vector<double>> sorted(members_.size());
    std::vector<MixtureDraws> draws;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      Band& alone = out_.members[k].band.noisy;
      if (!noisy_.has(k, i)) {
        add_unknown({&alone.lower, &alone.upper});
        continue;
      }
      sorted[k] = noisy_.sorted(k, i);
      add_limits({{1, sorted[k]}}, alone);
      if (!weights.empty() && weights[k] > 0) draws.push_back({weights[k], sorted[k]});
    }
    Band& band = out_.average.noisy;
    if (draws.empty()) return add_unknown({&band.lower, &band.upper});
    add_limits(draws, band);
  }

  std::vector<MemberQuantity const*> members_;
  std::vector<double> const& weights_;
  bool channel_;
  bool any_ = false;  // some member with a weight has a trajectory
  Drawn values_, noisy_, means_;
  AveragedBand out_;
};

AverageScores scores_of(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored, double log_score) {
  std::vector<Score> const found = scores(quantity, scored);
  auto const score = [&](ScoreKind kind) { return find_score(found, {kind}).value_or(not_a_number); };
  return {log_score, score(ScoreKind::nmse), score(ScoreKind::rmse), score(ScoreKind::coverage_95)};
}

}  // namespace

std::vector<AveragedBand> averaged_bands(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                         std::size_t lead) {
  std::vector<AveragedBand> out;
  for (MemberQuantity const& each : members[lead].quantities) {
    if (find(members[lead], each.name) != &each) continue;
    auto same = in_all(members, each);
    if (!same.empty()) out.push_back(AveragedQuantity(std::move(same), weights).run(members, members[lead].experiment.time.size()));
  }
  return out;
}

std::vector<ScoredChannel> averaged_scores(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                           std::string const& experiment, std::vector<AveragedBand>& bands) {
  std::vector<ScoredChannel> out;
  for (AveragedBand& band : bands) {
    PredictedQuantity const& quantity = band.average;
    if (quantity.measured.empty() || quantity.response.mean.empty()) continue;
    std::vector<MemberQuantity const*> same;
    std::vector<double> used = weights;  // 0 of members that no trajectory is left of
    double sum_of_weights = 0;
    for (std::size_t k = 0; k < members.size(); ++k) {
      same.push_back(find(members[k], quantity.name));
      if (std::ranges::all_of(same[k]->log_density, [](double x) { return std::isnan(x); })) used[k] = 0;
      sum_of_weights += used[k];
    }
    ScoredChannel channel{{experiment, quantity.name, quantity.unit, 0, {}, {}},
                          std::vector<std::uint8_t>(quantity.measured.size(), 0)};
    std::vector<double> sums(members.size(), 0);
    double sum = 0;
    for (std::size_t i = 0; i < channel.rows.size() && sum_of_weights > 0; ++i) {
      std::vector<double> densities;
      bool all = true;
      for (std::size_t k = 0; k < same.size(); ++k) {
        densities.push_back(same[k]->log_density[i]);
        all = all && (used[k] == 0 || !std::isnan(densities[k]));
      }
      if (!all) continue;
      channel.rows[i] = 1;
      ++channel.scores.samples;
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += densities[k];  // NaN of a member without weight that lacks samples
      sum += log_mixture_density(used, densities) - elementary::log(sum_of_weights);
    }
    if (channel.scores.samples == 0) continue;
    channel.scores.average = scores_of(quantity, channel.rows, sum / channel.scores.samples);
    std::vector<std::uint8_t> predicted = channel.rows;
    for (std::size_t i = 0; i < predicted.size(); ++i)
      if (!std::isfinite(quantity.response.mean[i])) predicted[i] = 0;
    for (std::size_t k = 0; k < members.size(); ++k) {
      PredictedQuantity& alone = band.members[k].band;
      alone.measured = quantity.measured;
      channel.scores.members.push_back(scores_of(alone, predicted, sums[k] / channel.scores.samples));
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
    VarianceShares shares{average.experiment, quantity.name, quantity.unit, not_a_number, not_a_number, not_a_number, not_a_number};
    if (std::isfinite(total)) {
      shares.sd = std::sqrt(total / rows);
      shares.parameter = parameter / total;
      shares.model = model / total;
      shares.noise = noise / total;
    }
    out.push_back(std::move(shares));
  }
  return out;
}

}  // namespace sysid
