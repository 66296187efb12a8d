// Block of rows by block from the end of the record, so that what comes later is known when a block is predicted from its past.
#include "app/fit/record_scores.hpp"

#include <algorithm>
#include <cmath>

#include "app/fit/earlier_posterior.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr double small_k = 0.5;  // of weighted draws of the whole posterior, where draws of its own do not reach an earlier one
constexpr int history = blocks_of_record / 2;  // blocks before the first that is predicted from its past alone

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
  RecordScores(FinishedFit& fit, Criteria& criteria, int experiment, SomeDraws const& draws, OwnDraws own)
      : fit_(fit),
        criteria_(criteria),
        index_(experiment),
        experiment_(fit.data[static_cast<std::size_t>(experiment)].experiment),
        pointwise_(fit.likelihood.pointwise(experiment)),
        scored_(*pointwise_),
        chains_(draws.chains),
        own_(own),
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
    near_ = some_of(draws.columns);
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
  /// On the sampler's coordinates.
  LaneArray some_of(LaneArray const& declared) const {
    int const count = std::min(own_.walkers, declared.width());
    LaneArray some(declared.rows(), count), theta(fit_.target.dimension(), count);
    for (int i = 0; i < some.rows(); ++i)
      for (int w = 0; w < count; ++w)
        some(i, w) = declared(i, static_cast<int>(static_cast<long long>(w) * declared.width() / count));
    fit_.target.unconstrain(some, theta);
    return theta;
  }

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
    std::optional<BlockScore> own;
    if (!future_.tells_nothing()) own = by_own_draws(b);
    bool const by_own = own && !own->elpd.empty();
    BlockScore const before = by_own ? *own : future_.score(block, own ? small_k : largest_k_of_many, influence);
    going_back_ = !before.elpd.empty();
    if (!going_back_) return;
    keep(before, &PointwiseScores::elpd_future, b, futures_);
    if (by_own) ++futures_.own_draws;
  }

  /// By draws of the posterior of the rows before the block; without scores where these do not reach it. Nothing where there are no
  /// such draws.
  std::optional<BlockScore> by_own_draws(int b) {
    int const from = scored_.first_row(b), to = scored_.end_row(b);
    double const samples = static_cast<double>(to - from) * pointwise_->channels();
    auto const most = static_cast<int>(std::min(most_densities / samples, 1e6));
    auto const draws = earlier_draws(fit_, index_, from, own_.round, most, near_);
    if (!draws || fit_.session.interrupted()) return std::nullopt;
    if (draws->weights.pareto_k > largest_k_of_many) return BlockScore{draws->weights.pareto_k, {}};
    LaneArray block = densities_under(draws->declared, b);
    for (int i = 0; i < block.rows(); ++i)
      for (double& each : block.row(i))
        if (!std::isfinite(each)) each = -std::numeric_limits<double>::infinity();
    DrawInfluence influence(static_cast<std::size_t>(block.width()));
    BlockScore score = score_block(draws->weights, block, influence);
    own_variance_ += influence.error() * influence.error();
    return score;
  }

  /// Of the samples of a block, as many draws at a time as a round has.
  LaneArray densities_under(LaneArray const& declared, int b) {
    int const from = scored_.first_row(b), to = scored_.end_row(b);
    LaneArray parameters(parameters_.rows(), declared.width());
    ParameterSpace const& space = fit_.likelihood.space();
    space.select(space.values_of_declared(declared), index_, parameters);
    LaneArray out;
    for (int first = 0; first < parameters.width(); first += own_.round) {
      ConstLanes const part = parameters.view().columns(first, std::min(own_.round, parameters.width() - first));
      LaneArray densities((to - from) * pointwise_->channels(), part.width());
      pointwise_->records(part, from, to, densities);
      fit_.extra.add_solves(static_cast<std::uint64_t>(part.width()));
      LaneArray const block = samples_of(b, densities, from);
      if (first == 0) out = LaneArray(block.rows(), parameters.width());
      for (int i = 0; i < block.rows(); ++i) std::ranges::copy(block.row(i), out.row(i).begin() + first);
    }
    return out;
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
  OwnDraws own_;
  int failed_ = 0;
  LaneArray parameters_;
  FutureOut future_;
  LaneArray near_;  // draws of the posterior of this block and those after it, as far as it is known
  std::size_t first_series_;
  bool going_back_ = false;
  LeftOutBlocks left_out_, futures_;
  double own_variance_ = 0;    // of the Monte Carlo error of what has draws of its own
  std::vector<Place> places_;  // of the samples of a block
};

}  // namespace

ScoredRecord score_record(FinishedFit& fit, Criteria& criteria, int experiment, SomeDraws const& draws, OwnDraws own,
                          DrawInfluence& loo, DrawInfluence& block, DrawInfluence& future) {
  RecordScores record(fit, criteria, experiment, draws, own);
  bool const ended = record.run(loo, block, future);
  return {ended, record.failed(), record.own_variance()};
}

}  // namespace sysid
