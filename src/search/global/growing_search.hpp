// A search on growing records: many local searches over the first rows, where they cost little and periods are not yet missed,
// fewer over more rows, a few over all.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "likelihood/target.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// The same parameters and prior, scored over the first part of each record.
struct FirstPart {
  std::unique_ptr<Target const> target;
  double share;  // of the time that a simulation of the whole takes
};

struct ShorterRecords {
  int rows = 0;    // scored, of the longest record
  int finest = 0;  // how often the solver may be refined
  /// null: the record is not to be cut. finer: how often the solver is refined.
  std::function<FirstPart(double share, int finer)> make = {};
  bool ordered = true;  // what is simulated at a row depends on time, or on the rows before
};

/// Whether a record is so long, and its parameters so many, that a search begins with a part of it: the Jacobian of its residuals
/// has 4,000 numbers or more, and half of the rows or less are enough to begin with.
bool worth_growing(Target const& target, ShorterRecords const& records);
/// Whether half of the rows or less are enough to begin with, however few there are.
bool can_grow(Target const& target, ShorterRecords const& records);

struct GrownModes {
  std::vector<Mode> modes;  // ranked; empty where none was found
  bool begun = false;       // a prior draw had a finite density
  std::uint64_t draws = 0;  // of the prior that were tried in vain or not
  int finer = 0;            // refinements of the solver that the modes are of
};

/// Local searches begin at the likeliest of 2048 prior draws, on the first 64 rows or on four residuals for each parameter,
/// whatever is more. Then the record is doubled, stage by stage. Each stage makes six rounds from
///
///   the places that the last one ended in, each once;
///   prior draws pulled onto them:  x = m + S V D V' S^-1 (draw - m),   D_i = 1/max(1, l_i),   with S C S = V diag(l) V'
///   the likeliest of 64 prior draws, as they are, up to a tenth of the record and where the mode was lost,
///
/// m such a place, C its curvature and S the widths of the prior: what the rows so far do not determine (l <= 1) is drawn from the
/// prior again. So no parameter is decided by rows that do not show it. As many are climbed from as cost the same in each stage.
///
/// A stage that more than doubles the misfit has lost its mode. It is made again from the same places with a finer solver, with
/// which the search goes on if the misfit stays; else with a quarter of the step, again and again, since what chaos parts is
/// followed over short steps. If it stays lost, the new rows show something new, and the stage begins at prior draws, too, as all
/// stages do up to a tenth of the record.
///
/// What is announced at the beginning, in simulations of the whole record, is kept, with one exception: local searches that are
/// not done when it is used up stay where they are, and say what they have left to gain. Another pass, from other draws, is made
/// while the best mode may have been missed and the rest pays for it. Where the whole record is followed worse than a part, two
/// stages are made from other draws; if they follow these rows better than the first pass did, it is made again from there, even if
/// nothing is left to pay for it: that is the exception. Simulations of a part count as their share in the ledger.
/// finer: how often the solver is refined from the beginning, no more than it may be.
GrownModes search_growing(Target const& whole, ObjectiveKind objective_kind, ShorterRecords const& records, RunContext& context,
                          int finer = 0);

}  // namespace sysid
