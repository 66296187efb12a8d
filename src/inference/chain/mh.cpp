// The run of Metropolis-Hastings chains.
#include "inference/chain/mh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/chain_checks.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/adaptation.hpp"
#include "inference/chain/chain_record.hpp"
#include "inference/chain/independence_learning.hpp"
#include "inference/chain/local_learning.hpp"
#include "inference/chain/metropolis.hpp"
#include "inference/chain/ridge.hpp"
#include "inference/chain/watch.hpp"
#include "search/laplace.hpp"
#include "search/search.hpp"

namespace sysid::mh {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "25000", 1, 1e9, "", "iterations of each chain, burn-in included"},
    {"burn_in", SettingKind::integer, "5000", 0, 1e9, "", "first iterations, discarded; the proposal adapts during them"},
    {"thin", SettingKind::integer, "10", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "4", 1, 65536, "", "number of independent chains"},
    {"proposal", SettingKind::word, "adaptive", 0, 0, "adaptive walk spherical",
     "adaptive: independence moves around the modes and a random walk, both adapted during burn-in; walk: the random walk alone; "
     "spherical: a random walk with covariance `variance` times the identity"},
    {"variance", SettingKind::real, "0.1", 1e-300, infinity, "",
     "variance of the spherical proposal, in unconstrained coordinates"},
    {"start", SettingKind::word, "global", 0, 0, "global prior",
     "where the chains start; global: around the modes of a search over the prior; prior: at draws from it"},
};

/// Unthinned draws are kept for the diagnostics while they fit into this many numbers (160 MB).
constexpr double most_recorded = 2e7;

/// Draws of all chains: more than any figure shows and any other program likes to read.
constexpr std::int64_t most_kept = 10'000'000;

/// A batch of 16 lanes takes half as long again as one of 4 on the machines we know, and a chain rejects three moves in four.
constexpr int lanes_worth_filling = 16, most_ahead = 8;

/// All that a run is between two iterations.
struct State {
  std::vector<std::uint64_t> next;  // [W] iterations each chain has finished: all the same in burn-in
  metropolis::State chains;
  std::vector<metropolis::Adaptation> groups;  // empty for a spherical proposal
  metropolis::IndependenceLearning independence;
  metropolis::LocalLearning local;
  std::vector<Mode> modes;
  Findings findings;  // of the search
  ChainRecord record;
};

struct Plan {
  std::uint64_t samples, burn_in, thin;
  int chains;
  bool adaptive, independent, global;
  double variance;
  std::uint64_t stride;  // between recorded iterations
};

Plan plan_of(Target const& target, Settings const& s) {
  Plan plan{static_cast<std::uint64_t>(s.integer("samples")),
            static_cast<std::uint64_t>(s.integer("burn_in")),
            static_cast<std::uint64_t>(s.integer("thin")),
            static_cast<int>(s.integer("chains")),
            s.word("proposal") != "spherical",
            s.word("proposal") == "adaptive",
            s.word("start") == "global",
            s.real("variance"),
            1};
  double const numbers = static_cast<double>(plan.samples - plan.burn_in) * plan.chains * (target.dimension() + 3);
  if (numbers > most_recorded) plan.stride = plan.thin;
  return plan;
}

nlohmann::json store(State const& state, Ledger const& ledger, nlohmann::json const& identity) {
  auto const block = [](std::vector<double> const& v) { return checkpoint::encode(std::span<double const>(v)); };
  nlohmann::json groups = nlohmann::json::array(), modes = nlohmann::json::array();
  for (auto const& group : state.groups) groups.push_back(group.store());
  for (Mode const& mode : state.modes) modes.push_back(checkpoint::encode(mode));
  return {{"identity", identity},
          {"next", state.next},
          {"theta", checkpoint::encode(state.chains.theta)},
          {"log_prior", block(state.chains.log_prior)},
          {"log_likelihood", block(state.chains.log_likelihood)},
          {"groups", groups},
          {"independence", state.independence.store()},
          {"local", state.local.store()},
          {"modes", modes},
          {"findings", checkpoint::encode(state.findings)},
          {"record", state.record.store()},
          {"ledger", checkpoint::encode(ledger)}};
}

State restore(nlohmann::json const& stored, Target const& target, Plan const& plan, Ledger& ledger) {
  State state;
  state.next = stored.at("next").get<std::vector<std::uint64_t>>();
  state.chains = {checkpoint::decode(stored.at("theta"), target.dimension(), plan.chains),
                  checkpoint::decode(stored.at("log_prior")), checkpoint::decode(stored.at("log_likelihood"))};
  auto const chains = static_cast<std::size_t>(plan.chains);
  if (state.next.size() != chains || state.chains.log_prior.size() != chains || state.chains.log_likelihood.size() != chains)
    throw checkpoint::Mismatch("its chains differ in number or dimension");
  for (auto const& group : stored.at("groups")) state.groups.push_back(metropolis::Adaptation::restore(group));
  state.independence = metropolis::IndependenceLearning::restore(stored.at("independence"), target.dimension());
  state.local = metropolis::LocalLearning::restore(stored.at("local"));
  for (auto const& mode : stored.at("modes")) state.modes.push_back(checkpoint::decode_mode(mode));
  state.findings = checkpoint::decode_findings(stored.at("findings"));
  state.record = ChainRecord::restore(stored.at("record"), target.dimension(), plan.chains);
  ledger = checkpoint::decode_ledger(stored.at("ledger"));
  return state;
}

/// Chains of one mode learn together.
std::vector<metropolis::Adaptation> make_groups(std::vector<Mode> const& modes, std::vector<int> const& mode_of_chain) {
  std::vector<metropolis::Adaptation> groups;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    std::vector<int> members;
    for (std::size_t c = 0; c < mode_of_chain.size(); ++c)
      if (mode_of_chain[c] == static_cast<int>(m)) members.push_back(static_cast<int>(c));
    if (!members.empty()) groups.emplace_back(std::move(members), covariance_of(modes[m]));
  }
  return groups;
}

/// A group for each chain, with the prior's widths: chains that start all over the prior have nothing in common yet.
std::vector<metropolis::Adaptation> make_prior_groups(Target const& target, int chains, std::uint64_t seed) {
  LaneArray draws(target.dimension(), 1000);
  target.sample_prior({seed, Purpose::start, 0, 0}, draws);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, draws);
  Eigen::MatrixXd const covariance = objective.scale.cwiseAbs2().asDiagonal();
  std::vector<metropolis::Adaptation> groups;
  for (int c = 0; c < chains; ++c) groups.emplace_back(std::vector<int>{c}, covariance);
  return groups;
}

/// The state before the first iteration, or why there is none.
std::optional<State> begin(Target const& target, Plan const& plan, RunContext& context, FitResult& result) {
  State state;
  LaneArray starts;
  if (plan.global) {
    SearchResult found = context.modes.empty() ? search(target, ObjectiveKind::posterior, context)
                                               : SearchResult{context.modes, context.mode_findings, {}, false};
    result.interrupted = found.interrupted;
    result.failure = found.failure;
    if (found.interrupted || found.failure) return std::nullopt;
    std::vector<int> const mode_of_chain = spread_over_modes(found.modes, plan.chains);
    starts = overdispersed_starts(target, found.modes, mode_of_chain, context);
    if (plan.adaptive) state.groups = make_groups(found.modes, mode_of_chain);
    if (plan.independent) state.independence = {target, found.modes, mode_of_chain};
    state.modes = std::move(found.modes);
    state.findings = std::move(found.findings);
  } else {
    std::optional<LaneArray> drawn = prior_starts(target, plan.chains, context);
    if (!drawn) {
      result.failure = no_finite_start(context.ledger, 1000);
      return std::nullopt;
    }
    starts = std::move(*drawn);
    if (plan.adaptive) state.groups = make_prior_groups(target, plan.chains, context.seed);
  }
  state.chains = metropolis::init(target, std::move(starts), context.ledger);
  state.record = ChainRecord(target.dimension(), plan.chains);
  state.next.assign(static_cast<std::size_t>(plan.chains), 0);
  return state;
}

/// The local moves to make now: with autoregressive ones where there is a mixture that they can go about.
metropolis::LocalMoves local_moves(std::span<metropolis::Proposal const* const> walks, State const& state) {
  if (!state.independence.active()) return {walks};
  return {walks, &state.independence.mixture(), state.local.step(), state.local.share()};
}

/// Independence moves along the ridge through the mode, if their draws are worth more. Interrupted, it has changed nothing.
void follow_ridge(Target const& target, std::uint64_t seed, Ledger& ledger, State& state) {
  Ledger spent;
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, 0);
  metropolis::Independence const along(metropolis::along_ridge(objective, state.modes.front(), spent));
  state.independence.see_ridge(along, metropolis::worth_of_draws(objective, along, seed, spent));
  ledger.merge(spent);
}

/// One batch of burn-in: an iteration of every chain, or a cycle of them with independence moves.
void burn_in(Target const& target, Plan const& plan, std::span<metropolis::Proposal const* const> walks, StreamKey key,
             Ledger& ledger, State& state) {
  if (state.independence.wants_ridge()) follow_ridge(target, key.seed, ledger, state);
  metropolis::Info info(static_cast<std::size_t>(plan.chains));
  auto const learn = [&](int chain, metropolis::Move const& move) {
    info[static_cast<std::size_t>(chain)] = move;
    if (chain + 1 < plan.chains) return;
    for (std::uint64_t& n : state.next) ++n;
    std::vector<char> away(info.size(), 0);
    if (state.independence.active()) {
      away = state.independence.away(target, state.chains);
      state.independence.learn(target, state.chains, info, away);
      state.local.learn(info);
    }
    for (auto& group : state.groups) group.learn(state.chains, info, away);
    state.record.count_burn_in(info);
  };
  metropolis::cycle(target, local_moves(walks, state), state.independence.mixture(), state.independence.moves_in_burn_in(),
                    key.with_step(state.next.front()), plan.burn_in, state.chains, ledger, learn);
  if (state.independence.active() && state.independence.end_cycle(target, state.groups))
    state.local.end_window(state.independence.too_few());
}

/// Iterates to the end, or until asked to stop or a batch is given up, of which nothing is kept; returns whether it was.
bool sample(Target const& target, Plan const& plan, RunContext& context, nlohmann::json const& identity, State& state) {
  metropolis::Proposal const fixed = metropolis::spherical(target.dimension(), plan.variance);
  std::vector<metropolis::Proposal const*> walks(static_cast<std::size_t>(plan.chains), &fixed);
  for (auto const& group : state.groups)
    for (int const chain : group.chains()) walks[static_cast<std::size_t>(chain)] = &group.proposal();
  StreamKey const key{context.seed, Purpose::proposal, 0, 0};
  Watch watch(context, [&] { return store(state, context.ledger, identity); });
  auto const look = [&] { watch.look(*std::min_element(state.next.begin(), state.next.end()), state.record.mean_acceptance()); };
  auto const record = [&](int chain, metropolis::Move const& move) {
    std::uint64_t const after = state.next[static_cast<std::size_t>(chain)] - plan.burn_in;
    state.record.add(chain, state.chains, move, after % plan.stride == 0);
  };
  auto const all_lags = [&](std::uint64_t iterations) {
    return std::all_of(state.next.begin(), state.next.end(), [&](std::uint64_t n) { return n >= iterations; });
  };

  context.progress.begin("sampling", plan.samples);
  bool stopped = false;
  auto const given_up = [&](auto const& batch) {
    try {
      batch();
    } catch (Interrupted const&) {
      stopped = true;
    }
    return stopped;
  };
  while (!stopped && !all_lags(plan.burn_in) && !(stopped = context.stop_requested())) {
    if (given_up([&] { burn_in(target, plan, walks, key, context.ledger, state); })) break;
    look();
  }
  // The proposals are frozen. Without independence moves idle lanes may run ahead. How far must not depend on the machine, or the
  // counts of solves would.
  int const ahead = std::clamp(lanes_worth_filling / plan.chains, 1, most_ahead), moves = state.independence.moves();
  metropolis::LocalMoves const local = local_moves(walks, state);
  auto const counted = [&](int chain, metropolis::Move const& move) {
    ++state.next[static_cast<std::size_t>(chain)];
    record(chain, move);
  };
  while (!stopped && !all_lags(plan.samples) && !(stopped = context.stop_requested())) {
    auto const batch = [&] {
      if (moves > 0)
        metropolis::cycle(target, local, state.independence.mixture(), moves, key.with_step(state.next.front()), plan.samples,
                          state.chains, context.ledger, counted);
      else
        metropolis::advance(target, local, key, ahead, plan.samples, state.next, state.chains, context.ledger, record);
    };
    if (given_up(batch)) break;
    look();
  }
  context.progress.end(!stopped);
  if (stopped || context.checkpoint_end) watch.store_now();
  return stopped;
}

void add_proposals(Target const& target, Plan const& plan, State const& state, FitResult& result) {
  for (auto const& group : state.groups) {
    metropolis::Proposal const& p = group.proposal();
    result.proposals.push_back({group.chains(), p.factor, p.scale});
  }
  if (!state.groups.empty()) return;
  metropolis::Proposal const fixed = metropolis::spherical(target.dimension(), plan.variance);
  std::vector<int> all;
  for (int c = 0; c < plan.chains; ++c) all.push_back(c);
  result.proposals.push_back({all, fixed.factor, fixed.scale});
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
  // All of them are held in memory and written out.
  if (std::int64_t const kept = (samples - burn_in) / thin * settings.integer("chains"); kept > most_kept)
    return fmt::format("{} draws would be kept, more than {}: increase `thin`, or use fewer samples", kept, most_kept);
  return {};
}

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  Plan const plan = plan_of(target, settings);
  nlohmann::json const identity = checkpoint::identity("mh", settings, context.seed, target);
  std::optional<State> state;
  if (context.resume) {
    result.failure = checkpoint::refuse(*context.resume, identity);
    if (result.failure) return result;
    // A run stopped during its search has nothing but its identity to resume from.
    if (context.resume->contains("next")) {
      try {
        state = restore(*context.resume, target, plan, context.ledger);
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
  state->record.write(target, plan.thin / plan.stride, plan.stride == 1, result);
  result.acceptance_rate = state->record.acceptance_rate();
  result.distinct_states = state->record.distinct_states();
  add_proposals(target, plan, *state, result);
  result.modes = state->modes;
  result.findings = state->findings;
  result.search_told = plan.global;
  if (plan.stride != 1)
    result.findings.push_back({FindingCode::diagnostics_on_thinned,
                               Severity::note,
                               {},
                               "the run is too long to keep every iteration: diagnostics use the thinned draws",
                               ""});
  if (result.draws.total() > 0) {
    result.summaries = summarise(result);
    for (Finding& finding :
         check_chains({result.summaries, result.acceptance_rate, result.distinct_states, plan.adaptive, &result.draws}))
      result.findings.push_back(std::move(finding));
  }
  return result;
}

}  // namespace sysid::mh
