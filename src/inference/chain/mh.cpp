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
#include "inference/chain/chain_run.hpp"
#include "inference/chain/independence_learning.hpp"
#include "inference/chain/local_learning.hpp"
#include "inference/chain/metropolis.hpp"
#include "inference/chain/ridge.hpp"
#include "inference/chain/ridge_moves.hpp"
#include "inference/chain/ridge_worth.hpp"
#include "inference/chain/scouts.hpp"
#include "inference/chain/watch.hpp"
#include "search/laplace.hpp"

namespace sysid::mh {
namespace {

constexpr double default_variance = 0.1;
constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "25000", 1, 1e9, "", "iterations of each chain, burn-in included"},
    {"burn_in", SettingKind::integer, "5000", 0, 1e9, "", "first iterations, discarded; the proposal adapts during them"},
    {"thin", SettingKind::integer, "10", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "4", 1, 65536, "", "number of independent chains"},
    {"proposal", SettingKind::word, "adaptive", 0, 0, "adaptive walk spherical",
     "adaptive: proposals drawn around the modes, independent of the current state, and a random walk, both adapted during "
     "burn-in; walk: the random walk alone; "
     "spherical: a random walk with covariance `variance` times the identity"},
    {"variance", SettingKind::real, "0.1", 1e-300, infinity, "",
     "variance of the spherical proposal, in unconstrained coordinates"},
    {"start", SettingKind::word, "global", 0, 0, "global prior",
     "where the chains start; global: around the modes of a search over the prior; prior: at draws from it"},
};

/// Unthinned draws are kept for the diagnostics while they fit into this many numbers (160 MB).
constexpr double most_recorded = 2e7;

/// A batch of 16 lanes takes half as long again as one of 4 on the machines we know, and a chain rejects three moves in four.
constexpr int lanes_worth_filling = 16, most_ahead = 8;

/// Iterations from one move along ridges to the next, where such moves are made: they cost a hundred times as much as others.
constexpr std::uint64_t ridge_interval = 3;

/// All that a run is between two iterations.
struct State : ChainRun {
  std::vector<std::uint64_t> next;  // [W] iterations each chain has finished: all the same in burn-in
  metropolis::State chains;
  std::vector<metropolis::Adaptation> groups;  // empty for a spherical proposal
  metropolis::IndependenceLearning independence;
  metropolis::LocalLearning local;
  metropolis::RidgeMoves ridge;
  metropolis::RidgeWorth ridge_worth;
  bool window_ended = false;  // one of burn-in, and what follows from it is still to be done
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
  nlohmann::json groups = nlohmann::json::array();
  for (auto const& group : state.groups) groups.push_back(group.store());
  nlohmann::json stored = sysid::store(state, ledger, identity);
  stored["next"] = state.next;
  stored["theta"] = checkpoint::encode(state.chains.theta);
  stored["log_prior"] = block(state.chains.log_prior);
  stored["log_likelihood"] = block(state.chains.log_likelihood);
  stored["groups"] = groups;
  stored["independence"] = state.independence.store();
  stored["local"] = state.local.store();
  stored["ridge"] = state.ridge.store();
  stored["ridge_worth"] = state.ridge_worth.store();
  stored["window_ended"] = state.window_ended;
  return stored;
}

void restore(nlohmann::json const& stored, Target const& target, Plan const& plan, State& state, Ledger& ledger) {
  sysid::restore(stored, target, plan.chains, state, ledger);
  state.next = stored.at("next").get<std::vector<std::uint64_t>>();
  state.chains = {checkpoint::decode(stored.at("theta"), target.dimension(), plan.chains),
                  checkpoint::decode(stored.at("log_prior")), checkpoint::decode(stored.at("log_likelihood"))};
  auto const chains = static_cast<std::size_t>(plan.chains);
  if (state.next.size() != chains || state.chains.log_prior.size() != chains || state.chains.log_likelihood.size() != chains)
    throw checkpoint::Mismatch("its chains differ in number or dimension");
  for (auto const& group : stored.at("groups"))
    state.groups.push_back(metropolis::Adaptation::restore(group, target.dimension(), plan.chains));
  state.independence = metropolis::IndependenceLearning::restore(stored.at("independence"), target.dimension(), plan.chains);
  state.local = metropolis::LocalLearning::restore(stored.at("local"));
  state.ridge = metropolis::RidgeMoves::restore(stored.at("ridge"), target.dimension());
  state.ridge_worth = metropolis::RidgeWorth::restore(stored.at("ridge_worth"), target.dimension());
  state.window_ended = stored.at("window_ended").get<bool>();
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
  Eigen::MatrixXd const covariance = widths_of_prior(target, seed).cwiseAbs2().asDiagonal();
  std::vector<metropolis::Adaptation> groups;
  for (int c = 0; c < chains; ++c) groups.emplace_back(std::vector<int>{c}, covariance);
  return groups;
}

/// The state before the first iteration; false where there is none.
bool begin(Target const& target, Plan const& plan, RunContext& context, State& state, FitResult& result) {
  std::optional<ChainStarts> starts = find_starts(target, plan.global, plan.chains, context, state, result);
  if (!starts) return false;
  if (plan.adaptive)
    state.groups =
        plan.global ? make_groups(state.modes, starts->mode_of_chain) : make_prior_groups(target, plan.chains, context.seed);
  if (plan.global && plan.independent) state.independence = {target, state.modes, starts->mode_of_chain};
  state.chains = metropolis::init(target, std::move(starts->theta), context.ledger);
  state.record = ChainRecord(target.dimension(), plan.chains);
  state.next.assign(static_cast<std::size_t>(plan.chains), 0);
  return true;
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
  metropolis::RidgeRow const row = metropolis::along_ridge(objective, state.modes.front(), spent);
  metropolis::Independence const along(row.components);
  state.independence.see_ridge(along, metropolis::worth_of_draws(objective, along, seed, spent), row.complete);
  ledger.merge(spent);
}

/// Whether scouts cost a small part of the run; an estimated density would hold them where it is too high by chance.
bool can_be_scouted(Target const& target, Plan const& plan) {
  std::uint64_t const run = plan.samples * static_cast<std::uint64_t>(plan.chains);
  return !target.is_expensive() && !target.is_estimated() && 5 * metropolis::cost_of_scouts(target.dimension()) <= run;
}

/// Looks for mass that neither the mixture nor the chains have reached. Interrupted, it has changed nothing.
void send_scouts(Target const& target, std::uint64_t seed, Ledger& ledger, State& state) {
  Ledger spent;
  Objective const objective = make_objective(target, ObjectiveKind::posterior, seed, 0);
  LaneArray const from = state.independence.archived(metropolis::scouts);
  LaneArray walked = metropolis::scout(objective, from, seed, state.independence.scoutings(), spent);
  metropolis::State const places = metropolis::init(target, std::move(walked), spent);
  if (std::optional<std::size_t> const found = state.independence.see_scouts(target, places)) {
    // A chain goes on from there: what moves along ridges are worth is seen where they are needed.
    for (int p = 0; p < places.theta.rows(); ++p) state.chains.theta(p, 0) = places.theta(p, static_cast<int>(*found));
    state.chains.log_prior.front() = places.log_prior[*found];
    state.chains.log_likelihood.front() = places.log_likelihood[*found];
  }
  ledger.merge(spent);
}

/// Whether the next iteration is a move along ridges.
bool at_ridge(State const& state) { return state.ridge.active() && state.next.front() % ridge_interval == 0; }

/// Where a cycle of other moves ends at the latest.
std::uint64_t end_of_cycle(State const& state, std::uint64_t end) {
  if (!state.ridge.active()) return end;
  return std::min(end, (state.next.front() / ridge_interval + 1) * ridge_interval);
}

/// Between windows of burn-in: begins moves along ridges where they may be needed, and ends them where they are not worth it.
void choose_ridge_moves(Target const& target, std::uint64_t seed, State& state) {
  if (state.ridge.active()) state.ridge_worth.end_window();
  if (!state.ridge_worth.worth())
    state.ridge = {};
  else if (!state.ridge.active() && state.independence.wants_ridge_moves() && !target.is_expensive())
    state.ridge = metropolis::RidgeMoves(make_objective(target, ObjectiveKind::posterior, seed, 0).scale);
}

/// One batch of burn-in: an iteration of every chain, or a cycle of them with independence moves.
void burn_in(Target const& target, Plan const& plan, std::span<metropolis::Proposal const* const> walks, StreamKey key,
             Ledger& ledger, State& state) {
  if (state.independence.wants_ridge()) follow_ridge(target, key.seed, ledger, state);
  metropolis::Info info(static_cast<std::size_t>(plan.chains));
  bool const ridge = state.ridge.active(), along_ridge = at_ridge(state);
  metropolis::State before = ridge ? state.chains : metropolis::State();
  auto const learn = [&](int chain, metropolis::Move const& move) {
    info[static_cast<std::size_t>(chain)] = move;
    if (chain + 1 < plan.chains) return;
    if (ridge) {
      state.ridge_worth.learn(before.theta, state.independence.log_weights(target, before), state.chains.theta, info);
      before = state.chains;
    }
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
  StreamKey const now = key.with_step(state.next.front());
  Ledger spent;
  if (along_ridge) {
    metropolis::Info const moves = state.ridge.step(target, now, state.chains, spent);
    state.ridge.learn(moves);
    for (int chain = 0; chain < plan.chains; ++chain) learn(chain, moves[static_cast<std::size_t>(chain)]);
  } else {
    metropolis::cycle(target, local_moves(walks, state), state.independence.mixture(), state.independence.moves_in_burn_in(), now,
                      end_of_cycle(state, plan.burn_in), state.chains, spent, learn);
  }
  if (ridge) state.ridge_worth.spend(along_ridge, spent.solves());
  ledger.merge(spent);
  state.window_ended = state.independence.active() && state.independence.end_cycle(target, state.groups, key.seed);
}

/// What follows from a window of burn-in: a batch of its own. Interrupted, it has changed nothing.
void follow_window(Target const& target, Plan const& plan, std::uint64_t seed, Ledger& ledger, State& state) {
  if (state.independence.wants_scouts(plan.burn_in) && can_be_scouted(target, plan)) send_scouts(target, seed, ledger, state);
  state.local.end_window(state.independence.too_few());
  choose_ridge_moves(target, seed, state);
  state.window_ended = false;
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
  auto const all_beyond = [&](std::uint64_t iterations) {
    return std::all_of(state.next.begin(), state.next.end(), [&](std::uint64_t n) { return n >= iterations; });
  };

  context.progress.begin("sampling", plan.samples);
  std::uint64_t const done = *std::min_element(state.next.begin(), state.next.end());
  target.expect_values(static_cast<double>(plan.samples - std::min(done, plan.samples)) * plan.chains);
  bool stopped = false;
  auto const given_up = [&](auto const& batch) {
    try {
      batch();
    } catch (Interrupted const&) {
      stopped = true;
    }
    return stopped;
  };
  auto const learn = [&] {
    if (state.window_ended)
      follow_window(target, plan, key.seed, context.ledger, state);
    else
      burn_in(target, plan, walks, key, context.ledger, state);
  };
  while (!stopped && (state.window_ended || !all_beyond(plan.burn_in)) && !(stopped = context.stop_requested())) {
    if (given_up(learn)) break;
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
  while (!stopped && !all_beyond(plan.samples) && !(stopped = context.stop_requested())) {
    auto const batch = [&] {
      StreamKey const now = key.with_step(state.next.front());
      if (at_ridge(state)) {
        metropolis::Info const made = state.ridge.step(target, now, state.chains, context.ledger);
        for (int chain = 0; chain < plan.chains; ++chain) counted(chain, made[static_cast<std::size_t>(chain)]);
      } else if (moves > 0 || state.ridge.active())
        metropolis::cycle(target, local, state.independence.mixture(), moves, now, end_of_cycle(state, plan.samples), state.chains,
                          context.ledger, counted);
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
  if (settings.word("proposal") != "spherical" && settings.real("variance") != default_variance)
    return "`variance` is that of `proposal = spherical`, the others adapt theirs";
  return refuse_kept(settings);
}

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  Plan const plan = plan_of(target, settings);
  nlohmann::json const identity = checkpoint::identity("mh", settings, context.seed, target);
  State state;
  if (!resume_or_begin(
          identity, context, result, [&](auto const& stored) { restore(stored, target, plan, state, context.ledger); },
          [&] { return begin(target, plan, context, state, result); }))
    return result;

  result.interrupted = sample(target, plan, context, identity, state);
  report(target, state, plan.thin, plan.stride, plan.global, result);
  add_proposals(target, plan, state, result);
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
