// What a finished selection is asked: does the likelihood agree, how far is the threshold above the noise, are distances the
// integrator's.
#pragma once
#include <vector>

#include "app/candidate.hpp"
#include "likelihood/selection_target.hpp"
#include "report/selection.hpp"

namespace sysid {

/// Laplace's model probabilities from the modes of each candidate's likelihood; names the worst difference from the particles'.
Findings add_likelihoods(std::vector<std::vector<Mode>> const& modes, SelectionReport& selection);

/// What noise leaves of the leading model's distance: the noise it states, or where a prior leaves that open the one that the first
/// of `modes` has found. Normal noise only.
Findings add_noise_floor(Session const& session, Candidate const& leading, Distance const& distance, std::vector<Mode> const& modes,
                         SelectionReport& selection);

/// Particles of a model once more with the next finer solver: their distances must not be those of the integrator.
Findings check_distances(SelectionTarget const& finer, int model, SelectionResult const& result, SolverSettings const& solver);

}  // namespace sysid
