// Known modes followed to a neighbouring target: a finer step, a shifted input, another rule between samples.
#pragma once
#include <functional>
#include <vector>

#include "likelihood/target.hpp"
#include "search/objective_kind.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Local searches on `target` from each of `modes`, which are those of a target with the same parameters and the same objective
/// kind. Modes come back in the order given (shares as they were); one whose density is not finite any more keeps its place with
/// log_density -infinity. `stop` ends it early: the modes as far as they have come.
std::vector<Mode> refit(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger, std::function<bool()> const& stop = {});

/// How far a parameter's limits, its value plus and minus its sd, lie apart in two modes: |change of value| + |change of sd|, in
/// units of `before`'s sd. Of the parameter for which that is largest; infinite where either is not finite.
struct Move {
  int parameter = 0;
  double size = 0;   // of value and sd together
  double value = 0;  // of the value alone
};
Move largest_move(Mode const& before, Mode const& after);

}  // namespace sysid
