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

}  // namespace sysid
