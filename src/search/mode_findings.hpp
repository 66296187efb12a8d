// What the modes of a search say about its result: others that count, and directions in which the best one is flat.
#pragma once
#include <vector>

#include "likelihood/target.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// Of a mode that is worth a word and a chain.
constexpr double notable_share = 0.01;

/// `second_mode`, one for all further modes of a notable share (of a likelihood, for all of nearly the same height), and
/// `flat_direction` once for each set of parameters. modes: best first, at least one.
Findings mode_findings(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes);

/// Takes such findings out, before those of other modes take their place.
void remove_mode_findings(Findings& findings);

/// The log density of the highest; -infinity without any.
double highest(std::vector<Mode> const& modes);

}  // namespace sysid
