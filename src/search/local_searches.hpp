// The results of many local searches: each mode once, with its Laplace approximation.
#pragma once
#include <functional>
#include <vector>

#include "search/descent.hpp"
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

/// By falling mass for a posterior, else by falling density, with their shares of it.
void rank(ObjectiveKind objective_kind, std::vector<Mode>& modes);

/// The modes that searches have ended in: of a finite density not more than 30 nats below the best, and at most 12. Ranked.
/// `stop` ends it early: the modes so far.
std::vector<Mode> modes_of(Objective const& objective, std::vector<Climber> climbers, Ledger& ledger,
                           std::function<bool()> const& stop = {}, Journal* journal = nullptr);

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
