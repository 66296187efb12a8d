// The run: population after population, batches of proposals within each.
#include "inference/abc/abc_smc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/interrupt.hpp"
#include "inference/abc/batch.hpp"
#include "inference/abc/findings.hpp"
#include "inference/abc/proposals.hpp"
#include "inference/abc/state.hpp"
#include "inference/abc/stops.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid::abc {
namespace {

using json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// Proposals of one batch: enough to fill lanes and threads, few enough that the last batch of a population wastes little.
constexpr int least_batch = 256, most_batch = 8192;

/// Failed simulations that are traced to a place; the others are counted.
constexpr std::uint64_t traced_failures = 8;

/// Prior draws that give a kernel its width before there is a population.
constexpr int width_draws = 1000;

/// Accepted particles expected of a model above which none at all is no chance: e^-3 is 5 %.
constexpr double surprising = 3;

/// A model that had fewer particles than these was proposed from places that need not be its best.
constexpr int few_particles = 10;

/// Simulations of each rank in one exchange, at least, where a population needs as many: they end at different times, and ranks
/// wait for the last.
constexpr int lanes_of_a_rank = 64;

/// Proposals that are simulated, from number `first` on.
struct Ahead {
  Ahead(SelectionTarget const& candidates, Proposals const& proposals, std::uint64_t first, int count, double threshold)
      : first(first), batch(candidates, proposals, first, count, threshold) {}
  std::uint64_t end() const { return first + batch.size(); }

  std::uint64_t first;
  Batch batch;
};

/// Those at [from, to) of a batch.
struct Part {
  Batch const* batch;
  std::size_t from, to;
};

class Run {
 public:
  Run(SelectionTarget const& candidates, Settings const& settings, RunContext& context, int at_once)
      : candidates_(candidates),
        at_once_(at_once),
        plan_(plan_of(settings)),
        walk_(candidates, plan_),
        context_(context),
        identity_(identity(candidates, settings, context.seed)) {
    result_.settings = settings;
  }

  SelectionResult run() {
    if (!begin()) return std::move(result_);
    while (!stop(end_after_population(state_, plan_)) && populate()) finish_population();
    finish();
    return std::move(result_);
  }

 private:
  // --- one population
  // -------------------------------------------------------------------------------------------------------------

  /// Fills the next population up; false when the run is stopped before it is full.
  bool populate() {
    Proposals const proposals(candidates_, plan_, walk_, context_.seed, last_);
    context_.progress.begin(fmt::format("population {}", next_.number), static_cast<std::uint64_t>(plan_.particles));
    bool full = record_.accepted >= plan_.particles;
    while (!full) {
      if (context_.stop_requested()) {
        result_.interrupted = true;
        break;
      }
      if (stop(end_within_population(state_, plan_, seconds()))) break;
      if (!propose(proposals)) break;
      full = record_.accepted >= plan_.particles;
      context_.progress.advance(static_cast<std::uint64_t>(next_.accepted()),
                                fmt::format("threshold {:.4g}, acceptance {:.2g}", next_.threshold, record_.acceptance()));
      saver_.save_sometimes();
    }
    context_.progress.end();
    return full && weigh(proposals);
  }

  /// What the rest of the population is expected to need.
  double needed() const {
    double const before = state_.records.empty() ? 1 : state_.records.back().acceptance();
    double const rate = record_.proposed == 0 ? before : (record_.accepted + 1.0) / static_cast<double>(record_.proposed + 1);
    return std::ceil((plan_.particles - record_.accepted) / std::max(rate, 1e-6));
  }

  double allowed() const { return static_cast<double>(plan_.simulations - state_.simulations() - record_.simulated); }

  /// How many proposals to count before it is asked whether to stop.
  int batch_size() const { return static_cast<int>(std::min(std::clamp<double>(needed(), least_batch, most_batch), allowed())); }

  /// A batch in which several ranks end together: as many as it has, or those of later batches with them.
  int simulated_at_once(int batch) const {
    return std::max(batch, static_cast<int>(std::min({needed(), allowed(), static_cast<double>(at_once_)})));
  }

  /// The next `count` proposals in parts, simulated here where they have not been.
  std::vector<Part> next_proposals(Proposals const& proposals, int count) {
    std::uint64_t const first = record_.proposed, end = first + static_cast<std::uint64_t>(count);
    while (!ahead_.empty() && ahead_.front().end() <= first) ahead_.pop_front();
    std::uint64_t const known = ahead_.empty() ? first : ahead_.back().end();
    if (known < end) {
      auto const left = static_cast<int>(end - known);
      ahead_.emplace_back(candidates_, proposals, known, std::max(left, simulated_at_once(count)), next_.threshold);
    }
    std::vector<Part> parts;
    for (Ahead const& each : ahead_)
      if (each.first < end)
        parts.push_back({&each.batch, static_cast<std::size_t>(std::max(each.first, first) - each.first),
                         static_cast<std::size_t>(std::min(each.end(), end) - each.first)});
    return parts;
  }

  /// False when the run is interrupted meanwhile: nothing of the batch is kept.
  bool propose(Proposals const& proposals) {
    try {
      std::vector<Part> const parts = next_proposals(proposals, batch_size());
      // Before anything is counted: an interruption throws.
      std::uint64_t const traced = std::min(context_.ledger.failed(), traced_failures);
      int wanted = plan_.particles - record_.accepted;
      std::vector<Batch::Place> places;
      for (Part const& each : parts) each.batch->find_failed_places(each.from, each.to, wanted, traced_failures - traced, places);
      std::size_t placed = 0;
      for (Part const& each : parts) count(each, places, placed);
      return true;
    } catch (Interrupted const&) {
      return !(result_.interrupted = true);
    }
  }

  /// Up to the proposal that fills the population. failed_places: of the first failures, `placed` of which are used up; the others
  /// are only counted.
  void count(Part const& part, std::vector<Batch::Place> const& failed_places, std::size_t& placed) {
    Batch const& batch = *part.batch;
    for (std::size_t i = part.from; i < part.to && record_.accepted < plan_.particles; ++i) {
      std::size_t const m = batch.model(i);
      ++record_.proposed;
      ++record_.models[m].proposed;
      if (!batch.is_simulated(i)) continue;
      ++record_.simulated;
      context_.ledger.add_solves(1);
      if (batch.ending(i) == Simulated::failed) {
        ++record_.failed;
        ++record_.models[m].failed;
        batch.note_failure(i, placed < failed_places.size() ? &failed_places[placed++] : nullptr, context_.ledger);
      }
      if (batch.ending(i) != Simulated::within) continue;
      batch.keep(i, next_.models[m]);
      ++record_.accepted;
    }
  }

  /// False when the run is interrupted before all weights are known: N particles cost N^2.
  bool weigh(Proposals const& proposals) {
    std::vector<std::vector<double>> logs;
    double highest = -infinity;
    auto const asked = [&] { return result_.interrupted = result_.interrupted || context_.stop_requested(); };
    for (std::size_t m = 0; m < next_.models.size(); ++m) {
      Particles const& particles = next_.models[m];
      LaneArray const x = particles.lanes(candidates_.dimension(static_cast<int>(m)));
      // Drawn from the prior, all weigh the same.
      logs.push_back(last_.number == 0 || particles.count() == 0
                         ? std::vector<double>(particles.distance.size(), 0.0)
                         : proposals.log_weights(static_cast<int>(m), x, particles.log_prior, asked));
      if (result_.interrupted) return false;
      for (double& log : logs.back()) {
        if (!(log < infinity)) log = -infinity;  // the kernel's density there is lost in rounding, and so is the weight
        highest = std::max(highest, log);
      }
    }
    if (highest == -infinity)
      return !stop(Stop{
          fmt::format("the proposal densities of population {} underflow, so its particles have no weights", next_.number), true});
    double total = 0;
    for (std::size_t m = 0; m < logs.size(); ++m)
      for (std::size_t j = 0; j < logs[m].size(); ++j) total += next_.models[m].weight[j] = elementary::exp(logs[m][j] - highest);
    for (Particles& particles : next_.models) {
      for (double& w : particles.weight) w /= total;
      if (!(particles.weight_sum() > 0)) particles = {};  // as good as none: neither widths nor a kernel can be made of them
    }
    return true;
  }

  /// Whether a model without particles may yet be as near as the others: it had so few proposals that at the others' acceptance
  /// rate none would be no surprise, or its last particles were too few to move it, or some of them are within the new threshold.
  bool may_be_chance(std::size_t m) const {
    if (last_.number > 0) {
      std::vector<double> const& before = last_.models[m].distance;
      if (static_cast<int>(before.size()) < few_particles) return true;
      if (*std::min_element(before.begin(), before.end()) <= next_.threshold) return true;
    }
    std::uint64_t const own = record_.models[m].proposed, others = record_.proposed - own;
    return static_cast<double>(own) * record_.accepted < surprising * static_cast<double>(others);
  }

  /// The population is whole: it becomes the last one.
  void finish_population() {
    record_.threshold = next_.threshold;
    record_.ess = next_.ess();
    for (std::size_t m = 0; m < next_.models.size(); ++m) {
      Particles const& particles = next_.models[m];
      auto& record = record_.models[m];
      record.particles = particles.count();
      double const sum = particles.weight_sum();
      record.probability = std::abs(sum - 1) < 1e-12 ? 1 : sum;  // all of it, but for rounding
      record.nearest = particles.count() == 0 ? infinity : *std::min_element(particles.distance.begin(), particles.distance.end());
      std::vector<double> within = particles.weight;
      for (double& w : within) w /= sum;
      next_.widths[m] = width_of(particles.lanes(candidates_.dimension(static_cast<int>(m))), within, last_.widths[m]);
      bool const lived = last_.number == 0 || last_.models[m].count() > 0;
      if (lived && particles.count() == 0)
        state_.departures[m] = {next_.number, may_be_chance(m), last_.number > 0 ? last_.models[m] : Particles{}};
    }
    state_.records.push_back(record_);
    last_ = std::move(next_);
    start_population();
    saver_.save();
  }

  /// Readies the next population and its threshold.
  void start_population() {
    next_ = {};
    next_.number = last_.number + 1;
    next_.models.resize(static_cast<std::size_t>(candidates_.size()));
    next_.widths = last_.widths;
    next_.threshold = following_threshold();
    record_ = {};
    record_.models.resize(next_.models.size());
    ahead_.clear();
  }

  double following_threshold() const {
    auto const place = static_cast<std::size_t>(last_.number);
    if (!plan_.schedule.empty()) return plan_.schedule[std::min(place, plan_.schedule.size() - 1)];
    if (last_.number == 0) return plan_.first_threshold;
    return std::max(last_.quantile(plan_.quantile), plan_.target);
  }

  // --- the end
  // --------------------------------------------------------------------------------------------------------------------

  bool stop(std::optional<Stop> const& why) {
    if (!why) return false;
    result_.stopped_by = why->why;
    result_.ran_out = why->ran_out;
    return true;
  }

  void finish() {
    // Where a run that goes on from here ends at once, too.
    if (result_.interrupted || last_.number > 0) saver_.save();
    if (last_.number == 0) {
      if (!result_.interrupted)
        result_.failure = no_population(record_, next_.threshold, plan_.particles, result_.stopped_by, context_.ledger);
      return;
    }
    result_.populations = state_.records;
    result_.threshold = last_.threshold;
    result_.next_threshold = next_.threshold;
    for (int m = 0; m < candidates_.size(); ++m) fill(m);
    result_.findings = check_populations(result_, plan_);
  }

  void fill(int m) {
    SelectedModel& model = result_.models[static_cast<std::size_t>(m)];
    State::Departure const& departure = state_.departures[static_cast<std::size_t>(m)];
    PopulationRecord const& record = result_.populations.back();
    model.died_in = departure.population;
    model.by_chance = departure.by_chance;
    model.probability = record.models[static_cast<std::size_t>(m)].probability;
    model.share = record.share(m);
    Particles const& particles = model.died_in > 0 ? departure.particles : last_.models[static_cast<std::size_t>(m)];
    LaneArray const x = particles.lanes(candidates_.dimension(m));
    model.theta = model.declared = x;
    walk_.to_theta(m, x, model.theta);
    walk_.to_declared(m, x, model.declared);
    double const sum = particles.weight_sum();
    for (double const w : particles.weight) model.weight.push_back(w / sum);
    model.distance = particles.distance;
    if (particles.count() == 0) return;
    for (int d = 0; d < x.rows(); ++d) {
      ParameterInfo const& info = model.parameters[static_cast<std::size_t>(d)];
      model.summaries.push_back(summarise_weighted(info.name, info.unit, model.declared.row(d), model.weight));
    }
  }

  // --- the beginning, and going on
  // ------------------------------------------------------------------------------------------------

  bool begin() {
    for (int m = 0; m < candidates_.size(); ++m) {
      SelectedModel model;
      model.name = candidates_.name(m);
      model.prior = candidates_.prior_probability(m);
      model.parameters.assign(candidates_.parameters(m).begin(), candidates_.parameters(m).end());
      result_.models.push_back(std::move(model));
    }
    if (context_.resume) {
      result_.failure = checkpoint::refuse(*context_.resume, identity_);
      if (result_.failure) return false;
      result_.failure = checkpoint::read([&] { state_ = restore(*context_.resume, candidates_, context_.ledger); });
      return !result_.failure;
    }
    for (int m = 0; m < candidates_.size(); ++m) last_.widths.push_back(prior_width(m));
    last_.models.resize(static_cast<std::size_t>(candidates_.size()));
    state_.departures.resize(last_.models.size());
    start_population();
    return true;
  }

  Width prior_width(int m) const {
    int const dimension = candidates_.dimension(m);
    LaneArray draws(dimension, width_draws), x = draws;
    candidates_.sample_prior(m, {context_.seed, Purpose::start, 0, 0}, draws);
    walk_.from_theta(m, draws, x);
    std::vector<double> const equal(width_draws, 1.0 / width_draws);
    return width_of(x, equal, {Eigen::MatrixXd::Identity(dimension, dimension), Eigen::VectorXd::Ones(dimension)});
  }

  /// Where something depends on it: the same on all ranks.
  double seconds() const {
    double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    if (plan_.wall_time == 0 || !ranks::together()) return seconds;
    std::string const of_leader = ranks::from_leader({reinterpret_cast<char const*>(&seconds), sizeof seconds});
    std::memcpy(&seconds, of_leader.data(), sizeof seconds);
    return seconds;
  }

  SelectionTarget const& candidates_;
  int const at_once_;
  Plan const plan_;
  Walk const walk_;
  RunContext& context_;
  json const identity_;
  SelectionResult result_;
  State state_;
  Population &last_ = state_.last, &next_ = state_.next;
  PopulationRecord& record_ = state_.record;
  std::deque<Ahead> ahead_;  // those that are not all counted, without gaps
  Clock::time_point const began_ = Clock::now();
  checkpoint::Saver saver_{context_, [this] { return store(state_, identity_, context_.ledger); }};
};

}  // namespace

SelectionResult run(SelectionTarget const& candidates, Settings const& settings, RunContext& context) {
  return run_wide(candidates, settings, context, ranks::together() ? lanes_of_a_rank * ranks::size() : 0);
}

SelectionResult run_wide(SelectionTarget const& candidates, Settings const& settings, RunContext& context, int at_once) {
  return Run(candidates, settings, context, at_once).run();
}

}  // namespace sysid::abc
