// Global search: prior draws in lanes, local searches from many of them, the modes they end in with their masses.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "likelihood/target.hpp"
#include "search/global/growing_search.hpp"
#include "search/objective.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

struct SearchResult {
  // By falling share for the posterior, by falling density for the others; at least one unless failed or interrupted.
  std::vector<Mode> modes;
  Findings findings;
  std::optional<Finding> failure;  // the likelihood is finite at no prior draw
  bool interrupted = false;
  int finer = 0;  // refinements of the solver that the search has made, because it followed the record with no coarser one
};

/// 2048 prior draws; a few Levenberg-Marquardt rounds from the likeliest 96 and from 32 others, since far from the optimum a noise
/// parameter that happens to match the misfit decides which draw is likeliest; to convergence from the best 16 distinct ones. When
/// a single one of them reaches the best mode the search is repeated on further draws, up to four times in all: a mode met once may
/// have a better neighbour that was not met. Where the target has a gradient, fewer: 64 draws, 8 of them climbed from, 4 to the
/// end; where an equation holds an unknown function, 16 are climbed from, its coefficients at zero, 3 to the end, in one pass.
/// Progress counts simulations against those of a typical search. Long records that can be cut are searched as
/// `search_growing` says; shorter ones, after this, where `second_look` finds reason to.
SearchResult search(Target const& target, ObjectiveKind objective_kind, RunContext& context, ShorterRecords const& records = {});

/// Local searches from `starts` [P x N] alone, which need not have a finite density: a search that somebody has aimed. What lies
/// elsewhere is not looked for, and a note says so.
SearchResult search_from(Target const& target, ObjectiveKind objective_kind, ConstLanes starts, RunContext& context,
                         std::string const& progress = "searching near an earlier fit");

/// The failure of a run whose prior holds no point with a finite likelihood.
Finding no_finite_start(Ledger const& ledger, std::uint64_t draws);

}  // namespace sysid
