// Stages of a search, each on more rows and from fewer places than the one before.
#include "search/global/growing_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "search/laplace.hpp"
#include "search/local_searches.hpp"
#include "search/settle.hpp"
#include "search/starts.hpp"
#include "search/work_left.hpp"

namespace sysid {
namespace {

constexpr double first_scored = 64;   // rows of the first part
constexpr double residuals_each = 4;  // of the first part, for each parameter
constexpr double longest_first_part = 0.5;
constexpr double long_jacobian = 4e3;  // numbers
constexpr int stage_rounds = 6;
constexpr double stage_simulations = 200;  // whole ones, of the rounds of a stage where its breadth allows
constexpr double least_breadth_at_first = 16, least_breadth = 4, most_breadth = 256, most_with_functions = 16;
constexpr double lost = 0.7;        // nats of each residual: the misfit doubles
constexpr double crept_away = 0.5;  // nats of each residual, over all stages: the misfit is 1.6 times as large
constexpr double worth_another_pass = 0.1;
constexpr int most_setbacks = 24;
constexpr std::size_t few_known = 6;
constexpr double doubtful = 0.1;  // share of the record up to which any stage may show what the ones before it did not
constexpr std::uint64_t growing_step = 5'000'000;  // a stream of its own among those of Purpose::start

double first_share(Target const& target, ShorterRecords const& records) {
  double const residuals = std::max(1, target.residual_count()), rows = std::max(1, records.rows);
  return std::max(first_scored / rows, residuals_each * target.dimension() / residuals);
}

/// Failures and solves of a part of the record as those of the whole that cost as much.
Ledger scaled(Ledger const& part, double share) {
  Ledger whole;
  for (Failure const& each : part.failures()) {
    auto const count = static_cast<std::uint64_t>(std::floor(share * static_cast<double>(each.count)));
    whole.add_failure(each.kind, each.where, each.time, each.example, std::max<std::uint64_t>(count, 1), each.names);
  }
  whole.add_solves(std::max(static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(part.solves()))), whole.failed()));
  return whole;
}

class GrowingSearch {
 public:
  GrowingSearch(Target const& whole, ObjectiveKind objective_kind, ShorterRecords const& records, RunContext& context, int finer)
      : whole_(whole),
        objective_kind_(objective_kind),
        records_(records),
        context_(context),
        breadth_(breadth_of(whole)),
        round_(static_cast<double>(simulations_per_round(whole))),
        first_share_(first_share(whole, records)),
        draws_(draw_prior(whole, key_, breadth_.draws)),
        scales_(make_objective(whole, ObjectiveKind::posterior, draws_)),
        budget_(context, "searching the prior on growing records", announced()),
        finer_(std::min(finer, records.finest)) {
    begin_without_functions(whole_, draws_);
  }

  GrownModes run() {
    GrownModes found;
    std::vector<Climber> ended;
    for (int pass = 0; pass < (has_coefficients(whole_) ? 1 : most_passes); ++pass) {
      double const before = budget_.spent();
      if (pass > 0) {
        draws_ = draw_prior(whole_, key_.with_index(static_cast<std::uint64_t>(pass * breadth_.draws)), breadth_.draws);
        begin_without_functions(whole_, draws_);
      }
      int const finer = finer_;
      std::vector<Climber> last = pass_once();
      if (looking_again_ && last.empty() && !stop_()) {  // the modes known stay, and the solver that they are of
        finer_ = finer;
        break;
      }
      looking_again_ = false;
      if (finer_ != finer) ended.clear();  // of another solver
      found.begun = found.begun || begun_;
      found.draws += static_cast<std::uint64_t>(breadth_.draws);
      ended.insert(ended.end(), std::make_move_iterator(last.begin()), std::make_move_iterator(last.end()));
      Objective const objective = on(whole(), objective_kind_);
      if (!ended.empty() && !stop_())
        found.modes = modes_of(objective, ended, context_.ledger, stop_, context_.journal, affordable_curvatures());
      if (stop_()) break;
      bool const enough = !found.modes.empty() && !may_be_missed(found.modes, searches_in(ended));
      if (enough && pass == 0 && has_crept_away())
        looking_again_ = true;
      else if (enough || (!ended.empty() && budget_.left() < budget_.spent() - before))
        break;
    }
    if (stop_()) found.modes.clear();
    found.finer = finer_;
    budget_.end(!stop_());
    return found;
  }

 private:
  /// Where local searches on a part of the record have come to.
  struct Stage {
    double share = 0;
    std::vector<Climber> climbers = {};  // apart, best first
    double fitted = -infinity;           // log density for each residual
  };

  Objective on(Target const& target, ObjectiveKind objective_kind) const { return scales_.over(target, objective_kind); }

  /// With the solver that the search has come to.
  Target const& whole() {
    if (finer_ == 0) return whole_;
    if (finer_of_ != finer_) finer_whole_ = records_.make(1, finer_).target;
    finer_of_ = finer_;
    return *finer_whole_;
  }

  static std::size_t searches_in(std::vector<Climber> const& climbers) {
    std::size_t sum = 0;
    for (Climber const& each : climbers) sum += static_cast<std::size_t>(each.hits);
    return sum;
  }

  /// Local searches of a stage.
  double breadth_at(double share) const {
    double const most = has_coefficients(whole_) ? most_with_functions : most_breadth,
                 least = share > 1.5 * first_share_ ? least_breadth : least_breadth_at_first;
    return std::clamp(std::floor(stage_simulations / (stage_rounds * round_ * share)), least, most);
  }

  /// Of that what is left pays for, with two in each later stage at least.
  double affordable_breadth(double share) const {
    double const later = 4 * stage_rounds * round_ + usual_end() / 2;
    double const most = (budget_.left() - later) / (share * (stage_rounds * round_ + 5));
    return std::clamp(std::floor(most), 2.0, breadth_at(share));
  }

  double cost_of_stage(double share) const { return share * (breadth_at(share) * (stage_rounds * round_ + 5) + fresh_draws); }
  double cost_from(double share) const {
    double sum = 0;
    for (; share < 1; share *= 2) sum += cost_of_stage(std::min(2 * share, 1.0));
    return sum;
  }
  /// Of one look at the curvature.
  double curvature_cost() const {
    double const p = whole_.dimension();
    return p > most_measured_in_full ? 2 * p + 1 : 2 * p * p + 1;
  }
  /// Of those at the end.
  double reserve() const { return std::max(2 * curvature_cost(), std::min(60 * curvature_cost(), 1000.0)); }
  int affordable_curvatures() const {
    return static_cast<int>(std::clamp(budget_.left() / (curvature_cost() + 5), 2.0, 1.0 * most_laplace_steps));
  }
  std::uint64_t announced() const {
    double const stages = first_share_ * breadth_.draws + cost_of_stage(first_share_) + cost_from(first_share_);
    return static_cast<std::uint64_t>(1.5 * stages + usual_end());
  }
  /// On the whole record.
  double usual_end() const { return least_breadth * usual_rounds * round_ + reserve(); }

  std::vector<Climber> pass_once() {
    Stage now = climb_on(first_share_, {}, Further::all);
    begun_ = !now.climbers.empty();
    double step = first_share_;
    int setbacks = 0, stages_of_pass = 0;
    while (now.share < 1 && !now.climbers.empty() && !stop_()) {
      double const next = now.share + 1.5 * step > 1 ? 1 : now.share + step;
      bool const doubted = now.share < doubtful;
      Stage longer = climb_on(next, now.climbers, doubted ? Further::all : Further::pulled);
      if (stop_()) return {};
      if (has_lost(longer, now) && affords_more(now.share)) {
        std::optional<Stage> held = with_finer_solver(next, longer, now);
        while (!held && step > now.share / 64 && setbacks < most_setbacks && affords_more(now.share) && !stop_()) {
          ++setbacks;
          step /= 4;
          held = climb_on(now.share + step, now.climbers, Further::none);
          if (has_lost(*held, now)) held.reset();
        }
        if (stop_()) return {};
        if (held) {
          longer = std::move(*held);
        } else {  // rows that show something new: to be searched as if from the beginning
          if (!doubted) longer = climb_on(next, now.climbers, Further::all);
          if (longer.climbers.empty()) longer = climb_on(next, {}, Further::all);
          step = next - now.share;
        }
      }
      step = std::min(setbacks > 0 ? 1.5 * step : 2 * step, longer.share);
      now = std::move(longer);
      if (looking_again_ && stages_of_pass == 0) {
        if (now.fitted < fitted_second_ + worth_another_pass) return {};
        budget_.add(static_cast<std::uint64_t>(std::max(0.0, cost_from(now.share) + usual_end() - budget_.left())));
      }
      if (++stages_of_pass == 1 && !looking_again_) fitted_second_ = now.fitted;
    }
    return stop_() ? std::vector<Climber>() : finish(std::move(now.climbers));
  }

  /// Searches of one pass descend from the first rows, and may agree on a wrong mode. It follows a longer record less and less
  /// well, though no single stage loses it. So does a wrong model: other draws of the prior tell them apart in two stages.
  bool has_crept_away() const { return fitted_at_end_ < fitted_before_ - crept_away; }
  static bool has_lost(Stage const& longer, Stage const& before) { return longer.fitted < before.fitted - lost; }
  bool affords_more(double share) const { return budget_.left() > usual_end() + cost_from(share); }

  /// What has been lost by too coarse a solver is found with a finer one, with which the search then goes on. lost_one: the stage
  /// on the rows up to `share` that has lost what `before` had.
  std::optional<Stage> with_finer_solver(double share, Stage const& lost_one, Stage const& before) {
    int const coarse = finer_;
    double fitted = lost_one.fitted;
    while (finer_ < records_.finest && affords_more(before.share) && !stop_()) {
      ++finer_;
      Stage const same = climb_on(before.share, before.climbers, Further::none);
      if (same.climbers.empty()) break;
      Stage stage = climb_on(share, same.climbers, Further::none);
      if (!has_lost(stage, before)) return stage;
      if (stage.fitted < fitted + lost / 2) break;
      fitted = stage.fitted;
    }
    finer_ = coarse;
    return std::nullopt;
  }

  /// from: best first; none: the prior.
  Stage climb_on(double share, std::vector<Climber> const& from, Further further) {
    ++stage_;
    FirstPart const part = share < 1 || finer_ > 0 ? records_.make(share, finer_) : FirstPart{nullptr, 1};
    Target const& target = part.target ? *part.target : whole_;
    Objective const objective = on(target, ObjectiveKind::posterior);
    Ledger ledger;
    budget_.count(&ledger, part.share);
    auto const breadth = static_cast<std::size_t>(affordable_breadth(part.share));
    std::vector<Climber> starts =
        from.empty() ? choose_starts(objective, draws_, {breadth_.draws, breadth - breadth / 4, breadth / 4, 0, 0}, ledger, stop_,
                                     context_.journal)
                     : starts_from(objective, from, further == Further::none ? std::min(breadth, few_known) : breadth, further,
                                   key_.with_step(growing_step + stage_), ledger, stop_, context_.journal);
    budget_.plan(fmt::format("{:.2g} % of the record, {} searches", 100 * part.share, starts.size()),
                 part.share * static_cast<double>(starts.size()) * stage_rounds * round_ + cost_from(share) + usual_end());
    std::vector<double> before;
    for (Climber const& each : starts) before.push_back(each.log_density);
    climb(objective, starts, stage_rounds, ledger, stop_, context_.journal);
    Stage stage{share, apart(objective, std::move(starts), before, share), -infinity};
    if (!stage.climbers.empty()) stage.fitted = stage.climbers.front().log_density / target.residual_count();
    budget_.count(nullptr, 1);
    context_.ledger.merge(scaled(ledger, part.share));
    double& fitted = share < 1 ? fitted_before_ : fitted_at_end_;
    fitted = std::max(fitted, stage.fitted);
    return stage;
  }

  /// Each place once; of long parts without those that would not come near the best at the rate of their last rounds.
  std::vector<Climber> apart(Objective const& objective, std::vector<Climber> climbers, std::vector<double> const& before,
                             double share) {
    constexpr int as_many_again = 10;
    if (share >= doubtful) climbers = within_reach(std::move(climbers), before, as_many_again);
    climbers = distinct(objective, std::move(climbers));
    std::erase_if(climbers, [](Climber const& each) { return !std::isfinite(each.log_density); });
    return climbers;
  }

  /// On the whole record, to their ends.
  std::vector<Climber> finish(std::vector<Climber> climbers) {
    if (climbers.empty()) return climbers;
    Objective const objective = on(whole(), objective_kind_);
    std::vector<Eigen::VectorXd> points;
    for (Climber const& each : climbers) points.push_back(each.theta);
    std::vector<double> const density =
        log_density_in_blocks(objective, to_lanes(points), context_.ledger, stop_, context_.journal);
    for (std::size_t k = 0; k < climbers.size(); ++k) {
      int const hits = climbers[k].hits;
      climbers[k] = climber_at(points[k], density[k]);
      climbers[k].hits = hits;
    }
    std::erase_if(climbers, [](Climber const& each) { return !std::isfinite(each.log_density); });
    budget_.plan(fmt::format("the whole record, {} searches", climbers.size()), usual_end());
    int const most = objective_kind_ == ObjectiveKind::posterior ? most_rounds_inside : breadth_.rounds;
    for (int round = 0; round < most && !climbers.empty(); round += rounds_together) {
      int const rounds = std::min(rounds_together, rounds_left(climbers.size()));
      if (rounds == 0 || stop_() || std::all_of(climbers.begin(), climbers.end(), [](Climber const& each) { return each.done; }))
        break;
      climbers = climb_together(objective, std::move(climbers), rounds, (most - round) / rounds_together, context_.ledger, stop_,
                                context_.journal)
                     .climbers;
    }
    settle_all(
        objective, climbers, [this](std::size_t searches) { return rounds_left(searches); }, context_.ledger, stop_,
        context_.journal);
    return climbers;
  }

  /// Rounds of so many searches that what is left pays for.
  int rounds_left(std::size_t searches) const {
    double const rounds = (budget_.left() - reserve()) / (round_ * static_cast<double>(std::max<std::size_t>(searches, 1)));
    return static_cast<int>(std::clamp(rounds, 0.0, 1000.0));
  }

  Target const& whole_;
  ObjectiveKind objective_kind_;
  ShorterRecords const& records_;
  RunContext& context_;
  StreamKey const key_{context_.seed, Purpose::start, 0, 0};
  Breadth const& breadth_;
  double const round_, first_share_;
  LaneArray draws_;
  Objective scales_;
  SearchBudget budget_;
  std::function<bool()> const stop_ = budget_.stop();
  std::uint64_t stage_ = 0;
  int finer_, finer_of_ = 0;  // refinements of the solver; those of the target below
  std::unique_ptr<Target const> finer_whole_;
  bool begun_ = false, looking_again_ = false;
  double fitted_second_ = -infinity;                              // of the second stage
  double fitted_before_ = -infinity, fitted_at_end_ = -infinity;  // of the best stage on a part of the record, and on all of it
};

}  // namespace

bool can_grow(Target const& target, ShorterRecords const& records) {
  return records.make && !target.climbs_by_gradient() && target.dimension() > 0 &&
         first_share(target, records) <= longest_first_part;
}

bool worth_growing(Target const& target, ShorterRecords const& records) {
  double const numbers = static_cast<double>(target.residual_count()) * target.dimension();
  return numbers >= long_jacobian && can_grow(target, records);
}

GrownModes search_growing(Target const& whole, ObjectiveKind objective_kind, ShorterRecords const& records, RunContext& context,
                          int finer) {
  return GrowingSearch(whole, objective_kind, records, context, finer).run();
}

}  // namespace sysid
