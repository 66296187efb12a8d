// The run of tempered replicas.
#include "inference/chain/tempering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/chain_checks.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/chain/chain_run.hpp"
#include "inference/chain/difference_moves.hpp"
#include "inference/chain/from_reference.hpp"
#include "inference/chain/ladder.hpp"
#include "inference/chain/metropolis.hpp"
#include "inference/chain/watch.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"

namespace sysid::tempering {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "12000", 1, 1e9, "", "iterations of each ensemble, burn-in included"},
    {"burn_in", SettingKind::integer, "4000", 0, 1e9, "",
     "first iterations, discarded; temperatures and proposals adapt during them"},
    {"thin", SettingKind::integer, "4", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "4", 1, 4096, "", "number of independent ensembles"},
    {"temperatures", SettingKind::integer, "16", 2, 512, "", "replicas of each ensemble, from the posterior to the prior"},
    {"start", SettingKind::word, "global", 0, 0, "global prior",
     "where the replicas start; global: around the modes of a search over the prior; prior: at draws from it"},
};

/// Iterations until the powers are first moved; then after twice as many, and so on.
constexpr std::uint64_t first_round = 100;
/// Below it states hardly pass, and an ensemble is a few chains in a row.
constexpr double least_exchange = 0.1;

struct Plan {
  std::uint64_t samples, burn_in, thin;
  int chains, rungs;
  bool global;
  int columns() const { return chains * rungs; }
};

Plan plan_of(Settings const& s) {
  return {static_cast<std::uint64_t>(s.integer("samples")), static_cast<std::uint64_t>(s.integer("burn_in")),
          static_cast<std::uint64_t>(s.integer("thin")),    static_cast<int>(s.integer("chains")),
          static_cast<int>(s.integer("temperatures")),      s.word("start") == "global"};
}

/// All that a run is between two iterations. Column k chains + c is the replica of ensemble c at rung k: the first are what is
/// kept.
struct State : ChainRun {
  std::uint64_t next = 0, round_end = first_round;
  metropolis::State replicas;
  Ladder ladder;
  std::vector<metropolis::DifferenceMoves> moves;  // [K - 1], none for the prior
};

nlohmann::json store(State const& state, Ledger const& ledger, nlohmann::json const& identity) {
  auto const block = [](std::vector<double> const& v) { return checkpoint::encode(std::span<double const>(v)); };
  nlohmann::json moves = nlohmann::json::array();
  for (auto const& each : state.moves) moves.push_back(each.store());
  nlohmann::json stored = sysid::store(state, ledger, identity);
  stored["next"] = state.next;
  stored["round_end"] = state.round_end;
  stored["theta"] = checkpoint::encode(state.replicas.theta);
  stored["log_prior"] = block(state.replicas.log_prior);
  stored["log_likelihood"] = block(state.replicas.log_likelihood);
  stored["ladder"] = state.ladder.store();
  stored["moves"] = moves;
  return stored;
}

void restore(nlohmann::json const& stored, Target const& target, Plan const& plan, State& state, Ledger& ledger) {
  sysid::restore(stored, target, plan.chains, state, ledger);
  state.next = stored.at("next").get<std::uint64_t>();
  state.round_end = stored.at("round_end").get<std::uint64_t>();
  auto const columns = static_cast<std::size_t>(plan.columns());
  state.replicas = {checkpoint::decode(stored.at("theta"), target.dimension(), plan.columns()),
                    checkpoint::decode(stored.at("log_prior"), columns), checkpoint::decode(stored.at("log_likelihood"), columns)};
  state.ladder = Ladder::restore(stored.at("ladder"), plan.rungs);
  for (auto const& each : stored.at("moves")) state.moves.push_back(metropolis::DifferenceMoves::restore(each, target.dimension()));
  if (state.moves.size() + 1 != static_cast<std::size_t>(plan.rungs)) throw checkpoint::Mismatch("its replicas differ in number");
}

/// What the archive of a rung holds at first: draws from the normal distributions at the modes, as wide as the power leaves them,
/// or from the prior where no search was made. They shape proposals alone.
LaneArray first_archive(Target const& target, std::vector<Mode> const& modes, Eigen::VectorXd const& widths, double power,
                        StreamKey key) {
  int const members = std::max(100, 10 * target.dimension());
  LaneArray archive(target.dimension(), members);
  if (modes.empty()) {
    target.sample_prior(key, archive);
    return archive;
  }
  std::vector<Eigen::MatrixXd> factors;
  for (Mode const& mode : modes) factors.push_back(cholesky_or_diagonal(covariance_at_power(mode, power, widths)));
  for (int w = 0; w < members; ++w) {
    Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
    double which = stream.uniform();
    std::size_t m = 0;
    while (m + 1 < modes.size() && which >= modes[m].share) which -= modes[m++].share;
    Eigen::VectorXd z(target.dimension());
    for (double& v : z) v = stream.normal();
    Eigen::VectorXd const x = theta_of(modes[m]) + factors[m] * z;
    for (int p = 0; p < target.dimension(); ++p) archive(p, w) = x(p);
  }
  return archive;
}

/// The state before the first iteration; false where there is none.
bool begin(Target const& target, Plan const& plan, RunContext& context, State& state, FitResult& result) {
  std::optional<ChainStarts> starts = find_starts(target, plan.global, plan.columns(), context, state, result);
  if (!starts) return false;
  state.ladder = Ladder(plan.rungs);
  constexpr std::uint64_t scale_step = 7'000'000;  // of streams that start this run, beyond those of the search
  Objective const objective = make_objective(target, ObjectiveKind::posterior, context.seed, scale_step);
  for (int k = 0; k + 1 < plan.rungs; ++k)
    state.moves.emplace_back(first_archive(target, state.modes, objective.scale, state.ladder.power(k),
                                           {context.seed, Purpose::start, 0, scale_step + 1 + static_cast<std::uint64_t>(k)}));
  state.replicas = metropolis::init(FromReference(target), std::move(starts->theta), context.ledger);
  state.record = ChainRecord(target.dimension(), plan.chains);
  return true;
}

/// One move of every replica.
metropolis::Info move(FromReference const& target, Plan const& plan, std::uint64_t seed, State& state, Ledger& ledger) {
  auto const columns = static_cast<std::size_t>(plan.columns());
  LaneArray proposed(target.dimension(), plan.columns()), drawn(target.dimension(), plan.chains);
  std::vector<char> whole(columns, 0);
  int const hottest = plan.columns() - plan.chains;
  auto const key = [&](Purpose purpose, int w) { return StreamKey{seed, purpose, static_cast<std::uint64_t>(w), state.next}; };
  for (int w = 0; w < hottest; ++w)
    whole[static_cast<std::size_t>(w)] = state.moves[static_cast<std::size_t>(w / plan.chains)].propose(
        key(Purpose::proposal, w), state.replicas.theta, w, proposed, w);
  target.sample_prior(key(Purpose::proposal, hottest), drawn);
  for (int c = 0; c < plan.chains; ++c)
    for (int p = 0; p < target.dimension(); ++p) proposed(p, hottest + c) = drawn(p, c);

  std::vector<double> log_prior(columns), log_likelihood(columns);
  target.log_prior(proposed, log_prior);
  target.log_likelihood(proposed, log_likelihood, ledger);
  metropolis::Info info(columns);
  for (std::size_t w = 0; w < columns; ++w) {
    auto const lane = static_cast<int>(w);
    // A draw from the prior is accepted there wherever the model can be solved.
    double const log_reverse = lane >= hottest ? state.replicas.log_prior[w] - log_prior[w] : 0;
    info[w] = metropolis::decide(key(Purpose::accept, lane), state.replicas, w, proposed, lane, log_prior[w], log_likelihood[w],
                                 {log_reverse, state.ladder.power(lane / plan.chains)});
    info[w].tunes_scale = whole[w] == 0;
  }
  return info;
}

/// Exchanges even pairs of neighbours at even iterations, odd ones at odd: states that move up go on upwards.
void exchange(Plan const& plan, std::uint64_t seed, State& state, metropolis::Info& info) {
  metropolis::State& replicas = state.replicas;
  for (int k = static_cast<int>(state.next % 2); k + 1 < plan.rungs; k += 2)
    for (int c = 0; c < plan.chains; ++c) {
      int const below = k * plan.chains + c, above = below + plan.chains;
      auto const a = static_cast<std::size_t>(below), b = static_cast<std::size_t>(above);
      double const probability = state.ladder.probability(k, replicas.log_likelihood[a], replicas.log_likelihood[b]);
      state.ladder.count(k, probability);
      Stream stream({seed, Purpose::exchange, static_cast<std::uint64_t>(below), state.next});
      if (stream.uniform() >= probability) continue;
      for (int p = 0; p < replicas.theta.rows(); ++p) std::swap(replicas.theta(p, below), replicas.theta(p, above));
      std::swap(replicas.log_prior[a], replicas.log_prior[b]);
      std::swap(replicas.log_likelihood[a], replicas.log_likelihood[b]);
      info[a].accepted = true;
    }
}

void learn(Plan const& plan, metropolis::Info const& info, State& state) {
  for (std::size_t k = 0; k < state.moves.size(); ++k)
    state.moves[k].learn(state.replicas, info, static_cast<int>(k) * plan.chains, plan.chains);
  state.record.count_burn_in({info.begin(), info.begin() + plan.chains});
  if (state.next + 1 == plan.burn_in) state.ladder.forget_counts();
  // The last third of burn-in leaves the powers alone, so that the moves fit those that stay.
  if (state.next + 1 < state.round_end || 3 * state.next > 2 * plan.burn_in) return;
  state.ladder.equalise();
  state.round_end *= 2;
}

/// The states of the coldest replicas into the record, with the prior and the likelihood of the posterior.
void keep(FromReference const& target, Plan const& plan, metropolis::Info const& info, State& state) {
  metropolis::State const& replicas = state.replicas;
  if (!target.changed()) {
    for (int c = 0; c < plan.chains; ++c) state.record.add(c, replicas, info[static_cast<std::size_t>(c)], true);
    return;
  }
  LaneArray cold(target.dimension(), plan.chains);
  for (int c = 0; c < plan.chains; ++c)
    for (int p = 0; p < cold.rows(); ++p) cold(p, c) = replicas.theta(p, c);
  std::vector<double> const surplus = target.surplus(cold);
  for (int c = 0; c < plan.chains; ++c) {
    auto const w = static_cast<std::size_t>(c);
    std::vector<double> theta;
    for (int p = 0; p < cold.rows(); ++p) theta.push_back(cold(p, c));
    state.record.add(c, theta, replicas.log_prior[w] + surplus[w], replicas.log_likelihood[w] - surplus[w], info[w]);
  }
}

/// Iterates to the end, or until asked to stop or a move is given up, of which nothing is kept; returns whether it was.
bool sample(Target const& posterior, Plan const& plan, RunContext& context, nlohmann::json const& identity, State& state) {
  FromReference const target(posterior);
  Watch watch(context, [&] { return store(state, context.ledger, identity); });
  context.progress.begin("sampling", plan.samples);
  target.expect_values(static_cast<double>(plan.samples - std::min(state.next, plan.samples)) * plan.columns());
  bool stopped = false;
  while (state.next < plan.samples && !(stopped = context.stop_requested())) {
    metropolis::Info info;
    try {
      info = move(target, plan, context.seed, state, context.ledger);
    } catch (Interrupted const&) {
      stopped = true;
      break;
    }
    exchange(plan, context.seed, state, info);
    if (state.next < plan.burn_in) learn(plan, info, state);
    if (state.next >= plan.burn_in) keep(target, plan, info, state);
    ++state.next;
    watch.look(state.next, state.record.mean_acceptance());
  }
  context.progress.end(!stopped);
  if (stopped || context.checkpoint_end) watch.store_now();
  return stopped;
}

Findings check_exchange(Plan const& plan, Ladder const& ladder) {
  double const least = ladder.least_acceptance();
  if (least >= least_exchange) return {};
  // Twice the barrier: neighbours are then exchanged about half of the time.
  int const enough = std::max(plan.rungs + 1, static_cast<int>(std::ceil(2 * ladder.barrier())) + 1);
  return {
      {FindingCode::replicas_do_not_mix,
       Severity::warning,
       {},
       fmt::format("the replicas hardly move between the prior and the posterior: between two neighbouring temperatures, only a "
                   "fraction of {:.2g} of the exchanges is accepted",
                   least),
       fmt::format("use temperatures = {}", std::min(enough, 512))}};
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) { return refuse_unthinned(settings); }

FitResult run(Target const& target, Settings const& settings, RunContext& context) {
  FitResult result;
  result.settings = settings;
  Plan const plan = plan_of(settings);
  nlohmann::json const identity = checkpoint::identity("tempering", settings, context.seed, target);
  State state;
  if (!resume_or_begin(
          identity, context, result, [&](auto const& stored) { restore(stored, target, plan, state, context.ledger); },
          [&] { return begin(target, plan, context, state, result); }))
    return result;

  result.interrupted = sample(target, plan, context, identity, state);
  report(target, state, plan.thin, 1, plan.global, result);
  if (result.draws.total() > 0) {
    result.summaries = summarise(result);
    for (Finding& finding : check_exchange(plan, state.ladder)) result.findings.push_back(std::move(finding));
    for (Finding& finding :
         check_chains({result.summaries, result.acceptance_rate, result.distinct_states, true, &result.draws, true}))
      result.findings.push_back(std::move(finding));
  }
  return result;
}

}  // namespace sysid::tempering
