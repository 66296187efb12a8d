// The results of many local searches: each mode once, with its Laplace approximation.
#pragma once
#include <functional>
#include <vector>

#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// By falling log density.
void sort_best_first(std::vector<Climber>& climbers);

/// So near each other, 0.05 prior widths in every coordinate, that they climb one hill.
bool in_one_basin(Objective const& objective, Climber const& a, Climber const& b);

/// One search stands for all in the same place as a better one: in one basin, and within its Gauss-Newton ellipsoid, which alone
/// may be far too wide where the likelihood is no sum of squares. Best first, `hits` summed.
std::vector<Climber> distinct(Objective const& objective, std::vector<Climber> climbers);

constexpr int rounds_together = 3;       // between two looks at which have met
constexpr int most_passes = 4;           // over all starts, while they find modes that were not known
constexpr int usual_rounds = 15;         // of a search that nothing hinders
constexpr int most_rounds_inside = 100;  // where the density vanishes at bounds, so that optima lie inside

/// Without those that at the rate of their last rounds would not come within 30 nats of the best in `as_many_again` times as many.
/// before: their log densities before these rounds.
std::vector<Climber> within_reach(std::vector<Climber> climbers, std::vector<double> const& before, int as_many_again);

struct ClimbedTogether {
  std::vector<Climber> climbers;  // apart, best first
  double reach;                   // log density that the best comes to at the rate of these rounds, in all that remain
};

/// So many rounds of each; those that meet go on as one, and a search is left where at this rate `as_many_again` times as many
/// would not bring it within 30 nats of the best. climbers: one at least.
ClimbedTogether climb_together(Objective const& objective, std::vector<Climber> climbers, int rounds, int as_many_again,
                               Ledger& ledger, std::function<bool()> const& stop, Journal* journal);

/// Local searches from near their ends to these, with more patience for those that may end highest. Best first before that
/// patience, which may change their order. affordable: rounds of so many searches that may be made.
void settle_all(Objective const& objective, std::vector<Climber>& climbers,
                std::function<int(std::size_t searches)> const& affordable, Ledger& ledger, std::function<bool()> const& stop,
                Journal* journal);

/// Whether the best mode was met once, which may have a better neighbour that was not met, or modes are so many that others may
/// well be missing: of the places where searches can end, those not seen hold w (w + 1) / (n (n - 1)) for w modes after n searches
/// (Boender and Rinnooy Kan 1987).
bool may_be_missed(std::vector<Mode> const& modes, std::size_t searches);

/// How many searches of the next pass go on to their ends, after one of `finalists` that ended in `ends`: where each of these has a
/// mode of its own that is nearly as high as the best, others that were left are a little lower, and twice as many go on, but no
/// more than there are `starts`. modes: of all passes.
std::size_t next_finalists(Objective const& objective, std::vector<Mode> const& modes, std::vector<Climber> ends,
                           std::size_t finalists, std::size_t starts);

/// By falling mass for a posterior, else by falling density, with their shares of it.
void rank(ObjectiveKind objective_kind, std::vector<Mode>& modes);

/// The modes that searches have ended in: of a finite density not more than 30 nats below the best; beyond 12, not more than
/// 5 nats below, and at most 64. Ranked.
/// `stop` ends it early: the modes so far. laplace_steps: of each at most.
std::vector<Mode> modes_of(Objective const& objective, std::vector<Climber> climbers, Ledger& ledger,
                           std::function<bool()> const& stop = {}, Journal* journal = nullptr,
                           int laplace_steps = most_laplace_steps);

struct LocalSearches {
  std::vector<Mode> modes;
  bool given_up = false;  // of too little mass to be climbed to the end: the place where that was seen
};

/// Local searches from `starts` [P x N], which need not have a finite density, to the modes they end in. Searches that meet go on
/// as one: together they cost little more than the longest. A search is left where, at the rate of its last rounds, all rounds that
/// remain would not bring it within 30 nats of the best. least_log_mass: modes of less are of no interest. Where no search can
/// reach one of more at that rate, with the largest volume that Laplace's approximation allows, the best stands for all where it
/// is.
LocalSearches modes_from(Target const& target, ObjectiveKind objective_kind, ConstLanes starts, double least_log_mass,
                         std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop = {}, Journal* journal = nullptr);

}  // namespace sysid
