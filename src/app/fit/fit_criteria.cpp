// How many draws are scored, and the sums over all records.
#include "app/fit/fit_criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/fit/earlier_posterior.hpp"
#include "app/fit/record_scores.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/statistics.hpp"
#include "criteria/scores.hpp"
#include "data/scored_samples.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

constexpr int most_draws = 4000, usual_draws = 1000, fewest_draws = 100;
constexpr double cheap = 2.5e5;  // densities that are taken whatever the fit took
constexpr int most_walkers = 256, fewest_walkers = 64;
constexpr double share_of_fit = 0.05;  // of its simulations, that the scores of its draws take

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
  std::vector<double> means;
  for (int p = 0; p < fit.target.dimension(); ++p) means.push_back(mean(draws.column(static_cast<std::size_t>(p))));
  fit.target.log_likelihood(coordinates_of(fit.target, means), log_likelihood, fit.extra);
  Deviance out{corrected_mean(deviances), corrected_variance(deviances), {}};
  if (std::isfinite(log_likelihood.front())) out.at_mean = -2 * log_likelihood.front();
  return out;
}

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
      ++criteria.pareto_counts[k <= 0.5 ? 0 : k <= largest_k_of_many ? 1 : k <= 1 ? 2 : 3];
      criteria.doubtful += k > largest_k(criteria.draws) ? 1 : 0;
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
  auto const cheap_draws = static_cast<int>(std::min<double>(most_draws, cheap / (channels * spans.record)));
  int draws = std::clamp(static_cast<int>(std::min(2 * most_densities / (channels * spans.block), 1e6)), fewest_draws,
                         std::max(usual_draws, cheap_draws));
  auto const cost = [&] { return draws * (std::ceil(draws * channels * spans.record / most_densities) + 1) / 2; };
  while (draws > std::max(fewest_draws, cheap_draws) && cost() > share_of_fit * simulations(fit))
    draws = std::max({fewest_draws, cheap_draws, draws * 19 / 20});
  return draws;
}

std::string why_none(FinishedFit const& fit) {
  if (!fit.likelihood.model().processes.empty())
    return "the samples are not independent given the parameters, because the model has a Gaussian process";
  if (fit.likelihood.model().filtered())
    return "the samples are not independent given the parameters, because the model has disturbances or random initial values";
  if (fit.result.draws.total() < 2) return "the fit has no posterior draws";
  return "";
}

/// As many as may take their steps within so many simulations.
int walkers_within(double simulations) {
  int const count = std::min(most_walkers, static_cast<int>(std::min(simulations / walk_steps, 1e6)));
  return count < fewest_walkers ? 0 : count;
}

void score_draws(FinishedFit& fit, Criteria& criteria) {
  SomeDraws const draws = spread_evenly(fit.result.draws, number_of_draws(fit));
  criteria.draws = draws.columns.width();
  criteria.in_time = fit.likelihood.model().dynamics != Dynamics::none;
  auto const width = static_cast<std::size_t>(criteria.draws);
  double const shared = share_of_fit * simulations(fit) / static_cast<double>(fit.data.size());
  OwnDraws const own{std::min({criteria.draws, usual_draws, std::max(fewest_draws, static_cast<int>(std::min(shared, 1e6)))}),
                     walkers_within(shared)};
  DrawInfluence loo(width), block(width), future(width);
  double own_variance = 0;
  for (int e = 0; e < static_cast<int>(fit.data.size()); ++e) {
    ScoredRecord const record = score_record(fit, criteria, e, draws, own, loo, block, future);
    if (!record.ended) {
      criteria.reason = record.failed == 0 ? "the run was interrupted"
                                           : fmt::format("{} of {} draws have no solution on {}", record.failed, criteria.draws,
                                                         fit.data[static_cast<std::size_t>(e)].experiment.name);
      criteria.pointwise.clear();
      criteria.blocks.clear();
      criteria.futures.clear();
      criteria.draws = 0;
      return;
    }
    own_variance += record.own_variance;
  }
  add_waic_and_counts(criteria);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  criteria.loo = sum_over(criteria, &PointwiseScores::elpd_loo, criteria.doubtful > 0 ? unknown : loo.error());
  if (!criteria.in_time) return;
  criteria.block =
      sum_over(criteria, &PointwiseScores::elpd_block, all_reached(criteria.blocks, criteria.draws) ? block.error() : unknown);
  LogScore const ahead = sum_over(criteria, &PointwiseScores::elpd_future, hypotenuse(future.error(), std::sqrt(own_variance)));
  if (ahead.samples > 0) criteria.future = ahead;
}

int scored_samples(FinishedFit const& fit) {
  int count = 0;
  for (ExperimentData const& each : fit.data) count += scored_count(each.experiment);
  return count;
}

}  // namespace

Criteria criteria_of(FinishedFit& fit) {
  Criteria criteria;
  criteria.reason = why_none(fit);
  if (!fit.likelihood.model().processes.empty()) return criteria;
  if (!fit.result.modes.empty() && !fit.target.is_estimated()) criteria.at_mode = at_mode(fit, scored_samples(fit));
  if (!criteria.reason.empty()) return criteria;
  criteria.deviance = deviance_of(fit);
  score_draws(fit, criteria);
  return criteria;
}

}  // namespace sysid
