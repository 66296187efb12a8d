// The run of no-U-turn chains.
#include "inference/nuts/nuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/chain_checks.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/chain_run.hpp"
#include "inference/chain/watch.hpp"
#include "inference/nuts/chain.hpp"
#include "inference/nuts/number_block.hpp"
#include "inference/nuts/trajectory_checks.hpp"
#include "search/laplace.hpp"

namespace sysid::nuts {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "1500", 1, 1e9, "", "iterations of each chain, burn-in included"},
    {"burn_in", SettingKind::integer, "500", 0, 1e9, "", "first iterations, discarded; step and metric adapt during them"},
    {"thin", SettingKind::integer, "1", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "4", 1, 65536, "", "number of independent chains"},
    {"acceptance", SettingKind::real, "0.8", 0.1, 0.999, "",
     "mean acceptance probability that the step is tuned to; higher: shorter steps, for densities of high curvature"},
    {"depth", SettingKind::integer, "10", 1, 15, "", "maximum number of doublings of a trajectory"},
    {"metric", SettingKind::word, "automatic", 0, 0, "automatic dense diagonal",
     "dense: the covariance of the posterior; diagonal: its variances alone; automatic: dense up to 100 parameters"},
    {"start", SettingKind::word, "global", 0, 0, "global prior",
     "where the chains start; global: around the modes of a search over the prior; prior: at draws from it"},
};

constexpr int most_dense = 100;  // parameters

struct Plan {
  std::uint64_t samples, thin;
  BurnIn burn_in;
  int chains, depth;
  double acceptance;
  bool dense, global;
};

Plan plan_of(Target const& target, Settings const& s) {
  std::string const metric = s.word("metric");
  return {static_cast<std::uint64_t>(s.integer("samples")),
          static_cast<std::uint64_t>(s.integer("thin")),
          plan_burn_in(static_cast<std::uint64_t>(s.integer("burn_in"))),
          static_cast<int>(s.integer("chains")),
          static_cast<int>(s.integer("depth")),
          s.real("acceptance"),
          metric == "dense" || (metric == "automatic" && target.dimension() <= most_dense),
          s.word("start") == "global"};
}

/// All that a run is between two leapfrog steps.
struct State : ChainRun {
  std::vector<Chain> chains;
};

StreamKey key_of(std::uint64_t seed, std::size_t chain) { return {seed, Purpose::proposal, chain, 0}; }

nlohmann::json store(State& state, Ledger const& ledger, nlohmann::json const& identity) {
  nlohmann::json chains = nlohmann::json::array();
  for (Chain& chain : state.chains) {
    NumberWriter writer;
    chain.visit(writer);
    chains.push_back(checkpoint::encode(std::span<double const>(writer.numbers())));
  }
  nlohmann::json stored = sysid::store(state, ledger, identity);
  stored["trajectories"] = chains;
  return stored;
}

void restore(nlohmann::json const& stored, Target const& target, Plan const& plan, std::uint64_t seed, State& state,
             Ledger& ledger) {
  sysid::restore(stored, target, plan.chains, state, ledger);
  for (auto const& each : stored.at("trajectories")) {
    NumberReader reader(checkpoint::decode(each));
    Chain& chain = state.chains.emplace_back();
    chain.visit(reader);
    reader.end();
    chain.resume(key_of(seed, state.chains.size() - 1), target.dimension());
  }
  if (state.chains.size() != static_cast<std::size_t>(plan.chains))
    throw checkpoint::Mismatch("its chains differ in number or dimension");
}

/// The log density and its gradient at the columns of theta [P x W].
std::vector<Point> evaluate(Target const& target, LaneArray const& theta, Ledger& ledger) {
  auto const width = static_cast<std::size_t>(theta.width());
  std::vector<double> log_prior(width), log_likelihood(width);
  LaneArray prior_gradient(theta.rows(), theta.width()), gradient(theta.rows(), theta.width());
  target.log_likelihood_gradient(theta, log_likelihood, gradient, ledger);
  target.log_prior_gradient(theta, log_prior, prior_gradient);
  std::vector<Point> points(width);
  for (std::size_t w = 0; w < width; ++w) {
    auto const lane = static_cast<int>(w);
    points[w].log_prior = log_prior[w], points[w].log_likelihood = log_likelihood[w];
    for (int p = 0; p < theta.rows(); ++p) {
      points[w].theta.push_back(theta(p, lane));
      points[w].gradient.push_back(gradient(p, lane) + prior_gradient(p, lane));
    }
  }
  return points;
}

/// The metrics that chains begin with: of each mode the covariance of its Laplace approximation; without modes the prior's widths.
std::vector<Metric> first_metrics(Target const& target, Plan const& plan, std::vector<Mode> const& modes, std::uint64_t seed) {
  std::vector<Metric> metrics;
  for (Mode const& mode : modes) metrics.push_back(metric_of(covariance_of(mode), plan.dense));
  if (!metrics.empty()) return metrics;
  return {metric_of(widths_of_prior(target, seed).cwiseAbs2().asDiagonal(), plan.dense)};
}

/// The state before the first step; false where there is none.
bool begin(Target const& target, Plan const& plan, RunContext& context, State& state, FitResult& result) {
  std::optional<ChainStarts> const starts = find_starts(target, plan.global, plan.chains, context, state, result);
  if (!starts) return false;
  std::vector<Metric> const metrics = first_metrics(target, plan, state.modes, context.seed);
  std::vector<Point> points = evaluate(target, starts->theta, context.ledger);
  for (std::size_t c = 0; c < points.size(); ++c)
    state.chains.emplace_back(key_of(context.seed, c), std::move(points[c]),
                              metrics[static_cast<std::size_t>(starts->mode_of_chain[c])], plan.acceptance, plan.depth);
  state.record = ChainRecord(target.dimension(), plan.chains);
  return true;
}

/// Takes the iteration that chain c has just finished into the record.
void record(Plan const& plan, std::size_t c, State& state) {
  Chain const& chain = state.chains[c];
  TrajectoryInfo const& last = chain.last();
  metropolis::Move const move{last.acceptance, last.moved};
  if (chain.iterations() <= plan.burn_in.length)
    state.record.count_burn_in(static_cast<int>(c), move);
  else
    state.record.add(static_cast<int>(c), chain.at().theta, chain.at().log_prior, chain.at().log_likelihood, move);
}

/// One leapfrog step of every chain that has not finished.
void step(Target const& target, Plan const& plan, State& state, Ledger& ledger) {
  std::vector<std::size_t> active;
  for (std::size_t c = 0; c < state.chains.size(); ++c)
    if (state.chains[c].iterations() < plan.samples) active.push_back(c);
  LaneArray theta(target.dimension(), static_cast<int>(active.size()));
  for (std::size_t w = 0; w < active.size(); ++w)
    for (int p = 0; p < theta.rows(); ++p)
      theta(p, static_cast<int>(w)) = state.chains[active[w]].asked()[static_cast<std::size_t>(p)];
  std::vector<Point> points = evaluate(target, theta, ledger);
  for (std::size_t w = 0; w < active.size(); ++w)
    if (state.chains[active[w]].take(std::move(points[w]), plan.burn_in)) record(plan, active[w], state);
}

/// Iterates to the end, or until asked to stop or a batch is given up, of which nothing is kept; returns whether it was.
bool sample(Target const& target, Plan const& plan, RunContext& context, nlohmann::json const& identity, State& state) {
  Watch watch(context, [&] { return store(state, context.ledger, identity); });
  auto const least = [&] {
    std::uint64_t done = plan.samples;
    for (Chain const& chain : state.chains) done = std::min(done, chain.iterations());
    return done;
  };
  context.progress.begin("sampling", plan.samples);
  bool stopped = false;
  while (least() < plan.samples && !(stopped = context.stop_requested())) {
    try {
      step(target, plan, state, context.ledger);
    } catch (Interrupted const&) {
      stopped = true;
      break;
    }
    watch.look(least(), state.record.mean_acceptance());
  }
  context.progress.end(!stopped);
  if (stopped || context.checkpoint_end) watch.store_now();
  return stopped;
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) { return refuse_unthinned(settings); }

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  Plan const plan = plan_of(target, settings);
  nlohmann::json const identity = checkpoint::identity("nuts", settings, context.seed, target);
  State state;
  if (!resume_or_begin(
          identity, context, result,
          [&](auto const& stored) { restore(stored, target, plan, context.seed, state, context.ledger); },
          [&] { return begin(target, plan, context, state, result); }))
    return result;

  result.interrupted = sample(target, plan, context, identity, state);
  report(target, state, plan.thin, 1, plan.global, result);
  if (result.draws.total() > 0) {
    result.summaries = summarise(result);
    std::vector<Tally> tallies;
    for (Chain const& chain : state.chains) tallies.push_back(chain.tally());
    for (Finding& finding : check_trajectories({target, result.draws, tallies, plan.acceptance, plan.depth}))
      result.findings.push_back(std::move(finding));
    for (Finding& finding : check_chains({result.summaries, result.acceptance_rate, result.distinct_states, true, &result.draws}))
      result.findings.push_back(std::move(finding));
  }
  return result;
}

}  // namespace sysid::nuts
