// Log densities of all scored samples under some draws, block of rows by block from the end of each record, and their scores.
#include "app/fit/fit_criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/fit/earlier_posterior.hpp"
#include "core/numeric/statistics.hpp"
#include "criteria/scores.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr int most_draws = 1000, fewest_draws = 100;
constexpr int blocks_of_record = 10;           // that are left out one by one
constexpr int history = blocks_of_record / 2;  // of these, before the first that is predicted from its past alone
constexpr double most_densities = (std::size_t{1} << 27) / sizeof(double);  // that are held at once

ScoreAtMode at_mode(FinishedFit& fit, int samples) {
  std::vector<double> log_likelihood(1);
  fit.target.log_likelihood(to_lanes({theta_of(fit.result.modes.front())}), log_likelihood, fit.extra);
  return {log_likelihood.front(), fit.target.dimension(), samples, fit.objective_kind == ObjectiveKind::likelihood};
}

Deviance deviance_of(FinishedFit& fit) {
  Draws const& draws = fit.result.draws;
  std::vector<double> deviances, log_likelihood(1);
  for (Chain const& chain : draws.chains)
    for (double const each : chain.log_likelihood) deviances.push_back(-2 * each);
  LaneArray declared(fit.target.dimension(), 1), theta(fit.target.dimension(), 1);
  for (int p = 0; p < declared.rows(); ++p) declared(p, 0) = mean(draws.column(static_cast<std::size_t>(p)));
  fit.target.unconstrain(declared, theta);
  fit.target.log_likelihood(theta, log_likelihood, fit.extra);
  Deviance out{corrected_mean(deviances), corrected_variance(deviances), {}};
  if (std::isfinite(log_likelihood.front())) out.at_mean = -2 * log_likelihood.front();
  return out;
}

/// At equal distances along each chain, the same number of each.
LaneArray spread_evenly(Draws const& draws, int per_chain) {
  auto const chains = static_cast<int>(draws.chains.size());
  LaneArray columns(draws.parameter_count, chains * per_chain);
  for (int c = 0; c < chains; ++c) {
    auto const& values = draws.chains[static_cast<std::size_t>(c)].values;
    for (int w = 0; w < per_chain; ++w) {
      auto const pick = static_cast<std::size_t>((2LL * w + 1) * static_cast<long long>(values.size()) / (2LL * per_chain));
      for (int p = 0; p < draws.parameter_count; ++p) columns(p, c * per_chain + w) = values[pick][static_cast<std::size_t>(p)];
    }
  }
  return columns;
}

/// The rows of an experiment that are scored in any channel, and where blocks of them end.
struct ScoredRows {
  std::vector<int> rows, ends;

  ScoredRows(PointwiseLikelihood const& pointwise) {
    for (int c = 0; c < pointwise.channels(); ++c)
      rows.insert(rows.end(), pointwise.samples(c).begin(), pointwise.samples(c).end());
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    ends = block_ends(static_cast<int>(rows.size()), blocks_of_record);
  }
  int blocks() const { return static_cast<int>(ends.size()) - 1; }
  int first_row(int block) const { return rows[static_cast<std::size_t>(ends[static_cast<std::size_t>(block)])]; }
  int end_row(int block) const { return rows[static_cast<std::size_t>(ends[static_cast<std::size_t>(block) + 1] - 1)] + 1; }
};

class RecordScores {
 public:
  RecordScores(FinishedFit& fit, Criteria& criteria, int experiment, LaneArray const& draws)
      : fit_(fit),
        criteria_(criteria),
        index_(experiment),
        experiment_(fit.data[static_cast<std::size_t>(experiment)].experiment),
        pointwise_(fit.likelihood.pointwise(experiment)),
        scored_(*pointwise_),
        chains_(static_cast<int>(fit.result.draws.chains.size())),
        parameters_(static_cast<int>(fit.likelihood.model().parameters.size()), draws.width()),
        future_(draws.width(), chains_),
        first_series_(criteria.pointwise.size()) {
    ParameterSpace const& space = fit.likelihood.space();
    space.select(space.values_of_declared(draws), experiment, parameters_);
    for (int c = 0; c < pointwise_->channels(); ++c) add_series(c);
    if (!criteria.in_time) return;
    left_out_.experiment = futures_.experiment = experiment_.name;
    left_out_.asked = scored_.blocks();
    futures_.asked = std::max(scored_.blocks() - history, 0);
    going_back_ = futures_.asked > 0;
  }

  /// False: a draw has no solution, or the user has interrupted.
  bool run(DrawInfluence& loo, DrawInfluence& block_influence, DrawInfluence& future_influence) {
    for (int last = scored_.blocks(); last > 0;) {
      int const first = first_of_part(last);
      int const from = scored_.first_row(first), to = scored_.end_row(last - 1);
      LaneArray densities((to - from) * pointwise_->channels(), parameters_.width());
      pointwise_->records(parameters_, from, to, densities);
      fit_.extra.add_solves(static_cast<std::uint64_t>(parameters_.width()));
      for (int b = last - 1; b >= first; --b) {
        if (fit_.session.interrupted()) return false;
        LaneArray const block = samples_of(b, densities, from);
        if (!finite(block)) return false;
        score(b, block, loo, block_influence, future_influence);
      }
      last = first;
    }
    if (criteria_.in_time) {
      std::reverse(left_out_.pareto_k.begin(), left_out_.pareto_k.end());
      std::reverse(futures_.pareto_k.begin(), futures_.pareto_k.end());
      criteria_.blocks.push_back(std::move(left_out_));
      criteria_.futures.push_back(std::move(futures_));
    }
    return true;
  }

  double own_variance() const { return own_variance_; }

 private:
  void add_series(int channel) {
    std::vector<int> const& samples = pointwise_->samples(channel);
    PointwiseScores series;
    series.experiment = experiment_.name;
    series.channel = fit_.likelihood.model().channels[static_cast<std::size_t>(channel)].name;
    for (int const row : samples) series.rows.push_back(experiment_.first_row + row);
    for (auto* column :
         {&series.log_density, &series.p_waic, &series.elpd_loo, &series.pareto_k, &series.elpd_block, &series.elpd_future})
      column->assign(samples.size(), std::nan(""));
    criteria_.pointwise.push_back(std::move(series));
  }

  /// The first of the blocks up to `last` that fit into memory together; at least one does.
  int first_of_part(int last) const {
    int first = last - 1;
    double const per_row = static_cast<double>(pointwise_->channels()) * parameters_.width();
    while (first > 0 && (scored_.end_row(last - 1) - scored_.first_row(first - 1)) * per_row <= most_densities) --first;
    return first;
  }

  /// Of each channel its place among its samples, and the row of the densities.
  struct Place {
    std::size_t channel, sample;
  };
  LaneArray samples_of(int block, LaneArray const& densities, int from) {
    places_.clear();
    std::vector<int> rows;
    for (int c = 0; c < pointwise_->channels(); ++c) {
      std::vector<int> const& samples = pointwise_->samples(c);
      auto at = std::lower_bound(samples.begin(), samples.end(), scored_.first_row(block));
      for (; at != samples.end() && *at < scored_.end_row(block); ++at) {
        places_.push_back({static_cast<std::size_t>(c), static_cast<std::size_t>(at - samples.begin())});
        rows.push_back((*at - from) * pointwise_->channels() + c);
      }
    }
    LaneArray out(static_cast<int>(rows.size()), densities.width());
    for (int i = 0; i < out.rows(); ++i) std::ranges::copy(densities.row(rows[static_cast<std::size_t>(i)]), out.row(i).begin());
    return out;
  }

  static bool finite(LaneArray const& values) {
    for (int i = 0; i < values.rows(); ++i)
      if (!std::ranges::all_of(values.row(i), [](double v) { return std::isfinite(v); })) return false;
    return true;
  }

  PointwiseScores& series_of(Place const& place) { return criteria_.pointwise[first_series_ + place.channel]; }

  void score(int b, LaneArray const& block, DrawInfluence& loo, DrawInfluence& block_influence, DrawInfluence& future_influence) {
    for (int i = 0; i < block.rows(); ++i) {
      Place const& place = places_[static_cast<std::size_t>(i)];
      SampleScore const score = score_sample(block.row(i), chains_, loo);
      PointwiseScores& series = series_of(place);
      series.log_density[place.sample] = score.log_density;
      series.p_waic[place.sample] = score.p_waic;
      series.elpd_loo[place.sample] = score.elpd_loo;
      series.pareto_k[place.sample] = score.pareto_k;
    }
    if (!criteria_.in_time) return;
    BlockScore const without = leave_block_out(block, chains_, block_influence);
    keep(without, &PointwiseScores::elpd_block, b, left_out_);
    if (going_back_ && b >= history) predict_from_past(b, block, future_influence);
  }

  void predict_from_past(int b, LaneArray const& block, DrawInfluence& influence) {
    future_.leave(block);
    BlockScore before;
    if (!future_.tells_nothing()) before = by_own_draws(b);
    if (before.elpd.empty())
      before = future_.score(block, influence);
    else
      ++futures_.own_draws;
    going_back_ = !before.elpd.empty();
    if (going_back_)
      keep(before, &PointwiseScores::elpd_future, b, futures_);
    else
      futures_.pareto_k.push_back(before.pareto_k);
  }

  /// By draws of the posterior of the rows before the block.
  BlockScore by_own_draws(int b) {
    int const from = scored_.first_row(b), to = scored_.end_row(b);
    auto const draws = earlier_draws(fit_, index_, from, parameters_.width());
    if (!draws || fit_.session.interrupted()) return {std::numeric_limits<double>::infinity(), {}};
    LaneArray parameters(parameters_.rows(), parameters_.width());
    ParameterSpace const& space = fit_.likelihood.space();
    space.select(space.values_of_declared(draws->declared), index_, parameters);
    LaneArray densities((to - from) * pointwise_->channels(), parameters.width());
    pointwise_->records(parameters, from, to, densities);
    fit_.extra.add_solves(static_cast<std::uint64_t>(parameters.width()));
    LaneArray block = samples_of(b, densities, from);
    for (int i = 0; i < block.rows(); ++i)
      for (double& each : block.row(i))
        if (!std::isfinite(each)) each = -std::numeric_limits<double>::infinity();
    DrawInfluence influence(static_cast<std::size_t>(parameters.width()));
    BlockScore score = score_block(draws->weights, block, influence);
    own_variance_ += influence.error() * influence.error();
    return score;
  }

  void keep(BlockScore const& score, std::vector<double> PointwiseScores::*column, int b, LeftOutBlocks& blocks) {
    blocks.pareto_k.push_back(score.pareto_k);
    blocks.first_row = experiment_.first_row + scored_.first_row(b);
    blocks.last_row = std::max(blocks.last_row, experiment_.first_row + scored_.end_row(b) - 1);
    for (std::size_t i = 0; i < places_.size(); ++i) (series_of(places_[i]).*column)[places_[i].sample] = score.elpd[i];
  }

  FinishedFit& fit_;
  Criteria& criteria_;
  int index_;
  Experiment const& experiment_;
  std::unique_ptr<PointwiseLikelihood> pointwise_;
  ScoredRows scored_;
  int chains_;
  LaneArray parameters_;
  FutureOut future_;
  std::size_t first_series_;
  bool going_back_ = false;
  LeftOutBlocks left_out_, futures_;
  double own_variance_ = 0;    // of the Monte Carlo error of what has draws of its own
  std::vector<Place> places_;  // of the samples of a block
};

LogScore sum_over(Criteria const& criteria, std::vector<double> PointwiseScores::*column, double monte_carlo_error) {
  std::vector<double> all;
  for (PointwiseScores const& each : criteria.pointwise) all.insert(all.end(), (each.*column).begin(), (each.*column).end());
  LogScore score = sum_of(all);
  score.monte_carlo_error = monte_carlo_error;
  return score;
}

void add_waic_and_counts(Criteria& criteria) {
  std::vector<double> elpd_waic;
  criteria.worst_k = -std::numeric_limits<double>::infinity();
  for (PointwiseScores const& series : criteria.pointwise)
    for (std::size_t i = 0; i < series.rows.size(); ++i) {
      elpd_waic.push_back(series.log_density[i] - series.p_waic[i]);
      criteria.p_waic += series.p_waic[i];
      criteria.p_loo += series.log_density[i] - series.elpd_loo[i];
      criteria.unstable_waic += series.p_waic[i] > largest_p_waic ? 1 : 0;
      double const k = series.pareto_k[i];
      ++criteria.pareto_counts[k <= 0.5 ? 0 : k <= largest_k ? 1 : k <= 1 ? 2 : 3];
      criteria.worst_k = std::max(criteria.worst_k, k);
    }
  criteria.waic = sum_of(elpd_waic);
}

int draws_per_chain(FinishedFit const& fit, int longest_row_count) {
  auto const chains = static_cast<int>(fit.result.draws.chains.size());
  auto const channels = static_cast<double>(fit.likelihood.model().channels.size());
  double const block = channels * std::ceil(longest_row_count / static_cast<double>(blocks_of_record));
  int const held = std::clamp(static_cast<int>(std::min(2 * most_densities / block, 1e6)), fewest_draws, most_draws);
  int shortest = std::max(held / chains, 1);
  for (Chain const& chain : fit.result.draws.chains) shortest = std::min(shortest, static_cast<int>(chain.values.size()));
  return shortest;
}

std::string why_none(FinishedFit const& fit) {
  if (!fit.likelihood.model().processes.empty())
    return "the samples are not independent given the parameters, because the model has a Gaussian process";
  if (fit.result.draws.total() < 2) return "the fit has no posterior draws";
  return "";
}

void score_draws(FinishedFit& fit, Criteria& criteria) {
  int longest = 0;
  for (ExperimentData const& each : fit.data) longest = std::max(longest, static_cast<int>(each.experiment.time.size()));
  LaneArray const draws = spread_evenly(fit.result.draws, draws_per_chain(fit, longest));
  criteria.draws = draws.width();
  criteria.in_time = fit.likelihood.model().dynamics != Dynamics::none;
  auto const width = static_cast<std::size_t>(draws.width());
  DrawInfluence loo(width), block(width), future(width);
  double own_variance = 0;
  for (int e = 0; e < static_cast<int>(fit.data.size()); ++e) {
    RecordScores record(fit, criteria, e, draws);
    if (!record.run(loo, block, future)) {
      criteria.pointwise.clear();
      criteria.reason = "a draw has no solution";
      return;
    }
    own_variance += record.own_variance();
  }
  add_waic_and_counts(criteria);
  criteria.loo = sum_over(criteria, &PointwiseScores::elpd_loo, loo.error());
  if (!criteria.in_time) return;
  criteria.block = sum_over(criteria, &PointwiseScores::elpd_block, block.error());
  LogScore const ahead = sum_over(criteria, &PointwiseScores::elpd_future, std::hypot(future.error(), std::sqrt(own_variance)));
  if (ahead.samples > 0) criteria.future = ahead;
}

int scored_samples(FinishedFit const& fit) {
  int count = 0;
  for (ExperimentData const& each : fit.data)
    for (std::size_t c = 0; c < each.experiment.measured.size(); ++c)
      for (std::size_t i = 0; i < each.experiment.time.size(); ++i) count += each.experiment.is_scored(c, i) ? 1 : 0;
  return count;
}

}  // namespace

Criteria criteria_of(FinishedFit& fit) {
  Criteria criteria;
  criteria.reason = why_none(fit);
  if (!fit.likelihood.model().processes.empty()) return criteria;
  if (!fit.result.modes.empty()) criteria.at_mode = at_mode(fit, scored_samples(fit));
  if (!criteria.reason.empty()) return criteria;
  criteria.deviance = deviance_of(fit);
  score_draws(fit, criteria);
  return criteria;
}

}  // namespace sysid
