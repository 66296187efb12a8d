// The run of no-U-turn chains.
#include "inference/nuts/nuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/chain_checks.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/chain_record.hpp"
#include "inference/chain/watch.hpp"
#include "inference/nuts/chain.hpp"
#include "inference/nuts/number_block.hpp"
#include "inference/nuts/trajectory_checks.hpp"
#include "search/laplace.hpp"
#include "search/search.hpp"

namespace sysid::nuts {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "1500", 1, 1e9, "", "iterations of each chain, burn-in included"},
    {"burn_in", SettingKind::integer, "500", 0, 1e9, "", "first iterations, discarded; step and metric adapt during them"},
    {"thin", SettingKind::integer, "1", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "4", 1, 65536, "", "number of independent chains"},
    {"acceptance", SettingKind::real, "0.8", 0.1, 0.999, "",
     "mean acceptance that the step is tuned to; higher: shorter steps, which follow sharper bends"},
    {"depth", SettingKind::integer, "10", 1, 15, "", "doublings of a trajectory at most"},
    {"metric", SettingKind::word, "automatic", 0, 0, "automatic dense diagonal",
     "dense: the covariance of the posterior; diagonal: its variances alone; automatic: dense to 100 parameters"},
    {"start", SettingKind::word, "global", 0, 0, "global prior",
     "where the chains start; global: around the modes of a search over the prior; prior: at draws from it"},
};

constexpr std::int64_t most_kept = 10'000'000;
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
struct State {
  std::vector<Chain> chains;
  std::vector<Mode> modes;
  Findings findings;  // of the search
  ChainRecord record;
};

StreamKey key_of(std::uint64_t seed, std::size_t chain) { return {seed, Purpose::proposal, chain, 0}; }

nlohmann::json store(State& state, Ledger const& ledger, nlohmann::json const& identity) {
  nlohmann::json chains = nlohmann::json::array(), modes = nlohmann::json::array();
  for (Chain& chain : state.chains) {
    NumberWriter writer;
    chain.visit(writer);
    chains.push_back(checkpoint::encode(std::span<double const>(writer.numbers())));
  }
  for (Mode const& mode : state.modes) modes.push_back(checkpoint::encode(mode));
  return {{"identity", identity},
          {"trajectories", chains},
          {"modes", modes},
          {"findings", checkpoint::encode(state.findings)},
          {"record", state.record.store()},
          {"ledger", checkpoint::encode(ledger)}};
}

State restore(nlohmann::json const& stored, Target const& target, Plan const& plan, std::uint64_t seed, Ledger& ledger) {
  State state;
  for (auto const& each : stored.at("trajectories")) {
    NumberReader reader(checkpoint::decode(each));
    Chain& chain = state.chains.emplace_back();
    chain.visit(reader);
    reader.end();
    chain.resume(key_of(seed, state.chains.size() - 1), target.dimension());
  }
  if (state.chains.size() != static_cast<std::size_t>(plan.chains))
    throw checkpoint::Mismatch("its chains differ in number or dimension");
  for (auto const& mode : stored.at("modes")) state.modes.push_back(checkpoint::decode_mode(mode));
  state.findings = checkpoint::decode_findings(stored.at("findings"));
  state.record = ChainRecord::restore(stored.at("record"), target.dimension(), plan.chains);
  ledger = checkpoint::decode_ledger(stored.at("ledger"));
  return state;
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
  LaneArray draws(target.dimension(), 1000);
  target.sample_prior({seed, Purpose::start, 0, 0}, draws);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, draws);
  return {metric_of(objective.scale.cwiseAbs2().asDiagonal(), plan.dense)};
}

/// The state before the first step, or why there is none.
std::optional<State> begin(Target const& target, Plan const& plan, RunContext& context, FitResult& result) {
  State state;
  LaneArray starts;
  std::vector<int> mode_of_chain(static_cast<std::size_t>(plan.chains), 0);
  if (plan.global) {
    SearchResult found = context.modes.empty() ? search(target, ObjectiveKind::posterior, context)
                                               : SearchResult{context.modes, context.mode_findings, {}, false};
    result.interrupted = found.interrupted;
    result.failure = found.failure;
    if (found.interrupted || found.failure) return std::nullopt;
    mode_of_chain = spread_over_modes(found.modes, plan.chains);
    starts = overdispersed_starts(target, found.modes, mode_of_chain, context);
    state.modes = std::move(found.modes);
    state.findings = std::move(found.findings);
  } else {
    std::optional<LaneArray> drawn = prior_starts(target, plan.chains, context);
    if (!drawn) {
      result.failure = no_finite_start(context.ledger, 1000);
      return std::nullopt;
    }
    starts = std::move(*drawn);
  }
  std::vector<Metric> const metrics = first_metrics(target, plan, state.modes, context.seed);
  std::vector<Point> points = evaluate(target, starts, context.ledger);
  for (std::size_t c = 0; c < points.size(); ++c)
    state.chains.emplace_back(key_of(context.seed, c), std::move(points[c]), metrics[static_cast<std::size_t>(mode_of_chain[c])],
                              plan.acceptance, plan.depth);
  state.record = ChainRecord(target.dimension(), plan.chains);
  return state;
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

std::string refuse(Settings const& settings) {
  std::int64_t const samples = settings.integer("samples"), burn_in = settings.integer("burn_in"), thin = settings.integer("thin");
  if (burn_in >= samples)
    return fmt::format("burn_in ({}) must be smaller than samples ({}), which counts all iterations", burn_in, samples);
  if (thin > samples - burn_in)
    return fmt::format("thin ({}) is more than the {} iterations left after burn-in, so no draw would be kept", thin,
                       samples - burn_in);
  if (std::int64_t const kept = (samples - burn_in) * settings.integer("chains"); kept > most_kept)
    return fmt::format("{} iterations would be kept in memory, more than {}: use fewer samples", kept, most_kept);
  return {};
}

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  Plan const plan = plan_of(target, settings);
  nlohmann::json const identity = checkpoint::identity("nuts", settings, context.seed, target);
  std::optional<State> state;
  if (context.resume) {
    result.failure = checkpoint::refuse(*context.resume, identity);
    if (result.failure) return result;
    // A run stopped during its search has nothing but its identity to resume from.
    if (context.resume->contains("trajectories")) {
      try {
        state = restore(*context.resume, target, plan, context.seed, context.ledger);
      } catch (checkpoint::Mismatch const& mismatch) {
        result.failure = checkpoint::unusable(mismatch.what());
      } catch (nlohmann::json::exception const&) {
        result.failure = checkpoint::unusable("it is damaged");
      }
      if (result.failure) return result;
    }
  }
  if (!state) state = begin(target, plan, context, result);
  if (!state) {
    if (result.interrupted && context.checkpoint) context.checkpoint({{"identity", identity}});
    return result;
  }

  result.interrupted = sample(target, plan, context, identity, *state);
  state->record.write(target, plan.thin, true, result);
  result.acceptance_rate = state->record.acceptance_rate();
  result.distinct_states = state->record.distinct_states();
  result.modes = state->modes;
  result.findings = state->findings;
  result.search_told = plan.global;
  if (result.draws.total() > 0) {
    result.summaries = summarise(result);
    std::vector<Tally> tallies;
    for (Chain const& chain : state->chains) tallies.push_back(chain.tally());
    for (Finding& finding : check_trajectories({target, result.draws, tallies, plan.acceptance, plan.depth}))
      result.findings.push_back(std::move(finding));
    for (Finding& finding : check_chains({result.summaries, result.acceptance_rate, result.distinct_states, true, &result.draws}))
      result.findings.push_back(std::move(finding));
  }
  return result;
}

}  // namespace sysid::nuts
