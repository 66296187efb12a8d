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
constexpr double share_of_fit = 0.05;          // of its simulations, that the scores of its draws take
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

/// Some of the draws, chain after chain, all chains of one length.
struct SomeDraws {
  LaneArray columns;  // [parameters x draws]
  int chains;
};

/// At equal distances along each chain, the same number of each; of more chains than `most`, one draw of some of them.
SomeDraws spread_evenly(Draws const& draws, int most) {
  auto const all = static_cast<int>(draws.chains.size());
  int const chains = std::min(all, most);
  int per_chain = most / chains;
  for (Chain const& chain : draws.chains) per_chain = std::min(per_chain, static_cast<int>(chain.values.size()));
  SomeDraws out{LaneArray(draws.parameter_count, chains * per_chain), chains};
  for (int c = 0; c < chains; ++c) {
    auto const& values = draws.chains[static_cast<std::size_t>(static_cast<long long>(c) * all / chains)].values;
    for (int w = 0; w < per_chain; ++w) {
      auto const pick = static_cast<std::size_t>((2LL * w + 1) * static_cast<long long>(values.size()) / (2LL * per_chain));
      for (int p = 0; p < draws.parameter_count; ++p) out.columns(p, c * per_chain + w) = values[pick][static_cast<std::size_t>(p)];
    }
  }
  return out;
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
  RecordScores(FinishedFit& fit, Criteria& criteria, int experiment, SomeDraws const& draws, int own_draws)
      : fit_(fit),
        criteria_(criteria),
        index_(experiment),
        experiment_(fit.data[static_cast<std::size_t>(experiment)].experiment),
        pointwise_(fit.likelihood.pointwise(experiment)),
        scored_(*pointwise_),
        chains_(draws.chains),
        own_draws_(own_draws),
        parameters_(static_cast<int>(fit.likelihood.model().parameters.size()), draws.columns.width()),
        future_(draws.columns.width(), chains_),
        first_series_(criteria.pointwise.size()) {
    ParameterSpace const& space = fit.likelihood.space();
    space.select(space.values_of_declared(draws.columns), experiment, parameters_);
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
        failed_ = lanes_without_density(block);
        if (failed_ > 0) return false;
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
  /// Draws without a solution; 0 where the user has interrupted.
  int failed() const { return failed_; }

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

  static int lanes_without_density(LaneArray const& values) {
    std::vector<char> without(static_cast<std::size_t>(values.width()), 0);
    for (int i = 0; i < values.rows(); ++i)
      for (int s = 0; s < values.width(); ++s)
        if (!std::isfinite(values(i, s))) without[static_cast<std::size_t>(s)] = 1;
    return static_cast<int>(std::ranges::count(without, 1));
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
    auto const draws = earlier_draws(fit_, index_, from, own_draws_);
    if (!draws || fit_.session.interrupted()) return {std::numeric_limits<double>::infinity(), {}};
    LaneArray parameters(parameters_.rows(), own_draws_);
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
  int chains_, own_draws_;
  int failed_ = 0;
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

/// Simulations of the whole model that the search and the sampling took.
double simulations(FinishedFit const& fit) {
  return static_cast<double>(fit.preparation.ledger.solves()) + static_cast<double>(fit.sampling.solves());
}

/// The most rows from the first to the last of a block, and from the first to the last of a record: unscored gaps are simulated
/// too.
struct Spans {
  int block = 1, record = 1;

  explicit Spans(std::vector<ExperimentData> const& data) {
    for (ExperimentData const& each : data) {
      std::vector<int> rows;
      for (std::size_t i = 0; i < each.experiment.time.size(); ++i)
        for (std::size_t c = 0; c < each.experiment.measured.size(); ++c)
          if (each.experiment.is_scored(c, i)) {
            rows.push_back(static_cast<int>(i));
            break;
          }
      std::vector<int> const ends = block_ends(static_cast<int>(rows.size()), blocks_of_record);
      for (std::size_t b = 1; b < ends.size(); ++b)
        block = std::max(block, 1 + rows[static_cast<std::size_t>(ends[b] - 1)] - rows[static_cast<std::size_t>(ends[b - 1])]);
      if (!rows.empty()) record = std::max(record, 1 + rows.back() - rows.front());
    }
  }
};

/// As many as a share of the fit's simulations allows, by counts, so that the same fit has the same draws on every machine. A
/// record that is simulated part by part, each from its beginning, takes the more of them the more draws there are.
int number_of_draws(FinishedFit const& fit) {
  Spans const spans(fit.data);
  auto const channels = static_cast<double>(fit.likelihood.model().channels.size());
  int draws = std::clamp(static_cast<int>(std::min(2 * most_densities / (channels * spans.block), 1e6)), fewest_draws, most_draws);
  auto const cost = [&] { return draws * (std::ceil(draws * channels * spans.record / most_densities) + 1) / 2; };
  while (draws > fewest_draws && cost() > share_of_fit * simulations(fit)) draws = std::max(fewest_draws, draws * 19 / 20);
  return draws;
}

std::string why_none(FinishedFit const& fit) {
  if (!fit.likelihood.model().processes.empty())
    return "the samples are not independent given the parameters, because the model has a Gaussian process";
  if (fit.result.draws.total() < 2) return "the fit has no posterior draws";
  return "";
}

void score_draws(FinishedFit& fit, Criteria& criteria) {
  SomeDraws const draws = spread_evenly(fit.result.draws, number_of_draws(fit));
  criteria.draws = draws.columns.width();
  criteria.in_time = fit.likelihood.model().dynamics != Dynamics::none;
  auto const width = static_cast<std::size_t>(criteria.draws);
  double const shared = share_of_fit * simulations(fit) / static_cast<double>(fit.data.size());
  int const own_draws = std::min(criteria.draws, std::max(fewest_draws, static_cast<int>(std::min(shared, 1e6))));
  DrawInfluence loo(width), block(width), future(width);
  double own_variance = 0;
  for (int e = 0; e < static_cast<int>(fit.data.size()); ++e) {
    RecordScores record(fit, criteria, e, draws, own_draws);
    if (!record.run(loo, block, future)) {
      criteria.reason = record.failed() == 0 ? "the run was interrupted"
                                             : fmt::format("{} of {} draws have no solution on {}", record.failed(), criteria.draws,
                                                           fit.data[static_cast<std::size_t>(e)].experiment.name);
      criteria.pointwise.clear();
      criteria.blocks.clear();
      criteria.futures.clear();
      criteria.draws = 0;
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
