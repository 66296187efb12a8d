// The run: pilots, burn-in that makes visits even, jumps and walks.
#include "inference/jump/reversible_jump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/jump/jump_result.hpp"
#include "inference/jump/state.hpp"

namespace sysid::jump {
namespace {

using json = nlohmann::json;

/// Draws of a mixture that are tried for a start.
constexpr std::uint64_t most_starts = 100;
constexpr std::uint64_t start_step = std::uint64_t{1} << 40;  // behind all iterations
constexpr double wanted_walks = 0.234;                        // acceptance (Roberts, Gelman and Gilks 1997)
constexpr std::uint64_t walk_window = 10;                     // cycles of burn-in between two changes of the walks' scale

class Run {
 public:
  Run(std::span<LikelihoodCandidate const> candidates, Settings const& settings, RunContext& context)
      : candidates_(candidates),
        plan_(plan_of(settings)),
        context_(context),
        identity_(identity(candidates, settings, context.seed)),
        key_{context.seed, Purpose::jump, 0, 0} {
    result_.settings = settings;
  }

  SelectionResult run() {
    if (!begin()) return std::move(result_);
    if (!explore_all()) return stopped();
    find_live();
    if (result_.failure) return std::move(result_);
    if (!iterate()) return stopped();
    if (context_.checkpoint_end) saver_.save();
    fill_result(candidates_, models_, plan_, state_, result_);
    return std::move(result_);
  }

 private:
  // --- the beginning
  // --------------------------------------------------------------------------------------------------------------

  bool begin() {
    for (LikelihoodCandidate const& each : candidates_) {
      SelectedModel model;
      model.name = each.name;
      model.prior = each.prior;
      model.parameters.assign(each.target->parameters().begin(), each.target->parameters().end());
      result_.models.push_back(std::move(model));
    }
    state_.pilots.resize(candidates_.size());
    if (!context_.resume) return true;
    result_.failure = checkpoint::refuse(*context_.resume, identity_);
    if (result_.failure) return false;
    result_.failure = checkpoint::read([&] { state_ = restore(*context_.resume, candidates_, plan_, context_.ledger); });
    return !result_.failure;
  }

  /// A pilot of each candidate. False: interrupted.
  bool explore_all() {
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (state_.pilots[k]) continue;
      KeptPilot const kept{state_.chains_of_pilot.is_null() ? nullptr : std::make_shared<json const>(state_.chains_of_pilot),
                           [&](json const& chains) {
                             state_.chains_of_pilot = chains;
                             saver_.save();
                           }};
      result_.failure = checkpoint::read([&] { state_.pilots[k] = explore(candidates_[k], plan_, context_, kept); });
      if (result_.failure) return true;
      if (!state_.pilots[k]) return false;
      state_.chains_of_pilot = json();
      if (context_.stop_requested()) return false;
    }
    return true;
  }

  /// The models that take part; their proposals are made of the pilots, which a checkpoint holds.
  void find_live() {
    if (result_.failure) return;
    bool const fresh = state_.live.empty();
    if (fresh)
      for (std::size_t k = 0; k < candidates_.size(); ++k)
        if (state_.pilots[k]->excluded.empty()) state_.live.push_back(static_cast<int>(k));
    if (state_.live.empty()) {
      result_.failure = Finding{
          FindingCode::no_finite_start,
          Severity::error,
          {},
          fmt::format("no candidate has a finite likelihood: `{}`: {}", candidates_.front().name, state_.pilots.front()->excluded),
          "check the equations and priors of the candidates; fit one of them on its own to see where "
          "simulations fail"};
      return;
    }
    for (int const k : state_.live) {
      auto const at = static_cast<std::size_t>(k);
      models_.push_back({&candidates_[at], state_.pilots[at]->mixture, 0, 1});
    }
    if (fresh) begin_chains();
    for (std::size_t m = 0; m < models_.size(); ++m) models_[m].bias = state_.bias[m], models_[m].scale = state_.scale[m];
  }

  void begin_chains() {
    std::size_t const models = models_.size();
    auto const count = static_cast<int>(models);
    for (int const k : state_.live) {
      auto const at = static_cast<std::size_t>(k);
      state_.bias.push_back(state_.pilots[at]->log_evidence + elementary::log(candidates_[at].prior));
    }
    state_.scale.assign(models, 1.0);
    for (auto* each : {&state_.visits, &state_.walks, &state_.walks_accepted, &state_.jumps_in, &state_.jumps_in_accepted,
                       &state_.jumps_out, &state_.jumps_out_accepted})
      each->assign(models, 0.0);
    state_.simulations.assign(models, 0);
    state_.weights.resize(models);
    state_.draws.resize(models);
    state_.burn_in = Tally(count, plan_.chains, 1);
    state_.tally = Tally(count, plan_.chains, static_cast<int>(plan_.parts()));
  }

  /// Each chain in a model in turn, at a draw of its mixture; in the next model where no draw can be simulated.
  void place_chains() {
    Ledger spent;
    std::vector<Place> places;
    for (int c = 0; c < plan_.chains; ++c) {
      std::optional<Place> place;
      for (std::size_t turn = 0; turn < models_.size() && !place; ++turn)
        place = place_in((static_cast<std::size_t>(c) + turn) % models_.size(), c, turn * most_starts, spent);
      if (!place) {
        result_.failure =
            Finding{FindingCode::no_finite_start,
                    Severity::error,
                    {},
                    fmt::format("no candidate has a finite likelihood at any of {} draws near its modes", most_starts),
                    "check the equations and priors of the candidates"};
        return;
      }
      places.push_back(std::move(*place));
    }
    context_.ledger.merge(spent);
    state_.places = std::move(places);
  }

  std::optional<Place> place_in(std::size_t m, int chain, std::uint64_t first_attempt, Ledger& spent) const {
    Model const& model = models_[m];
    for (std::uint64_t attempt = first_attempt; attempt < first_attempt + most_starts; ++attempt) {
      Place place{static_cast<int>(m), {}, 0, 0};
      if (!model.mixture.empty()) {
        LaneArray theta(model.candidate->target->dimension(), 1);
        model.mixture.draw(key_.at(static_cast<std::uint64_t>(chain), start_step + attempt), theta, 0);
        for (int p = 0; p < theta.rows(); ++p) place.theta.push_back(theta(p, 0));
      }
      Place* const one = &place;
      evaluate(models_, {&one, 1}, spent);
      if (place.log_density > -infinity) return place;
    }
    return std::nullopt;
  }

  // --- the moves
  // ------------------------------------------------------------------------------------------------------------------

  /// False: interrupted; what was begun is dropped.
  bool iterate() {
    context_.progress.begin("jumping between models", plan_.samples);
    for (Model const& model : models_)
      model.candidate->target->expect_values(static_cast<double>(plan_.samples - state_.next) * plan_.chains /
                                             static_cast<double>(models_.size()));
    bool whole = true;
    try {
      if (state_.places.empty()) place_chains();
      while (!result_.failure && state_.next < plan_.samples && (whole = !context_.stop_requested())) {
        if (Plan::is_walk(state_.next))
          walk_all();
        else
          jump_all();
        if (state_.next == plan_.burn_in) end_burn_in();
        context_.progress.advance(state_.next, fmt::format("jumps accepted {:.2g}", accepted()));
        saver_.save_sometimes();
      }
    } catch (Interrupted const&) {
      whole = false;
    }
    context_.progress.end(whole);
    return whole;
  }

  /// Up to the next walk, or the end of burn-in or of the run: where jumps go does not depend on where chains are.
  void jump_all() {
    std::uint64_t end = state_.next;
    while (end < plan_.samples && !Plan::is_walk(end) && (end == state_.next || end != plan_.burn_in)) ++end;
    std::vector<Place> proposed;
    for (std::uint64_t i = state_.next; i < end; ++i)
      for (int c = 0; c < plan_.chains; ++c) proposed.push_back(propose(models_, key_.at(static_cast<std::uint64_t>(c), i)));
    evaluate_all(proposed);
    for (std::size_t k = 0; k < proposed.size(); ++k) {
      auto const c = k % static_cast<std::size_t>(plan_.chains);
      decide_jump(static_cast<int>(c), state_.next + k / static_cast<std::size_t>(plan_.chains), std::move(proposed[k]));
    }
    state_.next = end;
  }

  void decide_jump(int chain, std::uint64_t iteration, Place to) {
    Place& now = state_.places[static_cast<std::size_t>(chain)];
    double const chance = jump_acceptance(models_, now, to);
    auto const from_model = static_cast<std::size_t>(now.model), to_model = static_cast<std::size_t>(to.model);
    bool const accepted = uniform_of(chain, iteration) < chance;
    if (iteration < plan_.burn_in) {
      state_.burn_in.add(chain, 0, now.model, to.model, chance);
    } else {
      state_.tally.add(chain, static_cast<int>(plan_.part_of(iteration)), now.model, to.model, chance);
      state_.weights[to_model].add(to.log_density == -infinity ? -infinity : to.log_density - to.log_proposal);
      if (now.model != to.model) {
        ++state_.jumps_in[to_model], ++state_.jumps_out[from_model];
        state_.jumps_in_accepted[to_model] += chance, state_.jumps_out_accepted[from_model] += chance;
      }
    }
    if (accepted) now = std::move(to);
    record(now, iteration);
  }

  void walk_all() {
    std::vector<Place> proposed;
    for (int c = 0; c < plan_.chains; ++c)
      proposed.push_back(
          walk(models_, state_.places[static_cast<std::size_t>(c)], key_.at(static_cast<std::uint64_t>(c), state_.next)));
    evaluate_all(proposed);
    for (int c = 0; c < plan_.chains; ++c) {
      Place& now = state_.places[static_cast<std::size_t>(c)];
      Place& to = proposed[static_cast<std::size_t>(c)];
      auto const m = static_cast<std::size_t>(now.model);
      double const chance = walk_acceptance(now, to);
      ++state_.walks[m];
      state_.walks_accepted[m] += chance;
      if (uniform_of(c, state_.next) < chance) now = std::move(to);
      record(now, state_.next);
    }
    ++state_.next;
    if (state_.next <= plan_.burn_in && state_.next % (walk_window * Plan::cycle) == 0) adapt_walks();
  }

  double uniform_of(int chain, std::uint64_t iteration) const {
    Stream stream({key_.seed, Purpose::accept, static_cast<std::uint64_t>(chain), (std::uint64_t{1} << 48) + iteration});
    return stream.uniform();
  }

  void evaluate_all(std::vector<Place>& places) {
    std::vector<Place*> all;
    for (Place& each : places) all.push_back(&each);
    Ledger spent;  // of a batch that is given up nothing is kept
    evaluate(models_, all, spent);
    context_.ledger.merge(spent);
    for (Place const& each : places) ++state_.simulations[static_cast<std::size_t>(each.model)];
  }

  void record(Place const& place, std::uint64_t iteration) {
    if (iteration < plan_.burn_in) return;
    auto const m = static_cast<std::size_t>(place.model);
    ++state_.visits[m];
    if ((iteration - plan_.burn_in + 1) % plan_.thin != 0) return;
    KeptDraws& draws = state_.draws[m];
    draws.theta.insert(draws.theta.end(), place.theta.begin(), place.theta.end());
    draws.log_density.push_back(place.log_density);
  }

  // --- adaptation
  // -----------------------------------------------------------------------------------------------------------------

  void adapt_walks() {
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (state_.walks[m] < 1) continue;
      double const rate = state_.walks_accepted[m] / state_.walks[m];
      state_.scale[m] *= elementary::exp(std::clamp(2 * (rate - wanted_walks), -0.5, 0.5));
      models_[m].scale = state_.scale[m];
      state_.walks[m] = state_.walks_accepted[m] = 0;
    }
  }

  /// From here on nothing adapts. Visits that were not even are made so.
  void end_burn_in() {
    std::vector<double> const shares = log_shares(state_.burn_in);
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (shares[m] > -infinity) state_.bias[m] += shares[m];
      models_[m].bias = state_.bias[m];
      state_.walks[m] = state_.walks_accepted[m] = 0;
    }
  }

  double accepted() const {
    Tally const& tally = state_.next > plan_.burn_in ? state_.tally : state_.burn_in;
    double chance = 0, proposed = 0;
    for (auto const& part : tally.all)
      for (std::size_t i = 0; i < part.chance.size(); ++i) chance += part.chance[i], proposed += part.proposed[i];
    return proposed > 0 ? chance / proposed : 0;
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------

  SelectionResult stopped() {
    result_.interrupted = true;
    saver_.save();
    return std::move(result_);
  }

  std::span<LikelihoodCandidate const> candidates_;
  Plan const plan_;
  RunContext& context_;
  json const identity_;
  StreamKey const key_;
  SelectionResult result_;
  State state_;
  std::vector<Model> models_;
  checkpoint::Saver saver_{context_, [this] { return store(state_, identity_, context_.ledger); }};
};

}  // namespace

SelectionResult run(std::span<LikelihoodCandidate const> candidates, Settings const& settings, RunContext& context) {
  return Run(candidates, settings, context).run();
}

}  // namespace sysid::jump
