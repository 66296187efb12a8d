// Known modes followed to a neighbouring target: a finer step, a shifted input, another rule between samples.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "likelihood/target.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

class Journal;

/// Local searches on `target` from each of `modes`, which are those of a target with the same parameters and the same objective
/// kind. Modes come back in the order given (shares as they were); one whose density is not finite any more keeps its place with
/// log_density -infinity. `stop` ends it early: the modes as far as they have come. gains, where asked for: by how much each search
/// has raised the log density of `target`.
std::vector<Mode> refit(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger, std::function<bool()> const& stop = {}, std::vector<double>* gains = nullptr,
                        Journal* journal = nullptr);

/// Whether a declared value lies at a bound of its prior's support: within a thousandth of the support's width, or of a positive
/// lower bound; where the support has one bound only and so no width, within a tenth of the value's sd. Coordinates end there at
/// infinity, so that what a Laplace approximation says of the parameter means nothing.
bool at_bound(ParameterInfo const& parameter, double declared, double sd);

/// How far a parameter's limits, its value plus and minus its sd, lie apart in two modes, in units of `before`'s sd.
struct Move {
  int parameter = 0;
  double value = 0;  // |change of value|
  double width = 0;  // |change of sd|

  double size() const { return value + width; }
};

/// Of every parameter that has an sd, in `before`, the mode whose sds are the measure, or else in `after`; both parts infinite
/// where a mode is not finite.
///
/// One is what `refit` made of the other on another target; gain: by how much that raised its log density there. Sds are not
/// believed blindly. At a bound they mean nothing: a parameter that is there in both modes has not moved. Along a direction that
/// nothing resists they are the prior's: their change is none, and where `after` is resisted its sds are the measure, since a step
/// that is too large may tie what the data leave open. And where the curvature is right, a move by a sds gains a^2/2 at least:
/// where less than a quarter of that was gained, the curvature is wrong, and the move is what the gain allows, sqrt(2 gain). So it
/// is for what moves most where a direction is flat in either mode and more than 1/2 was gained though nothing moves by a fifth of
/// that.
std::vector<Move> moves_between(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain);
/// The largest of them.
Move largest_move(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain);

}  // namespace sysid
