// Checks of a finished selection: does the likelihood agree, how far is the threshold above the noise, is noise all that the
// leading model leaves, are distances the integrator's.
#pragma once
#include <vector>

#include "app/selection/candidate_posterior.hpp"
#include "diagnostics/residuals/residual_checks.hpp"
#include "likelihood/selection/model_selection_target.hpp"
#include "result/selection.hpp"

namespace sysid {

/// Laplace's model probabilities from the modes of each candidate's likelihood, densities in the units of the first candidate;
/// names each large difference from the particles', and takes back the warning of a death by chance that the likelihood confirms.
/// After `add_noise_floor`, on which the help depends.
void add_likelihoods(std::vector<Candidate> const& candidates, std::vector<CandidatePosterior> const& posteriors,
                     SelectionReport& selection, Findings& findings);

/// What noise leaves of the distance: the noise that the leading model states, or where a prior leaves that open the smallest one
/// that any candidate's mode has found; a place where a climb was given up is none. Normal noise only.
void add_noise_floor(Session const& session, std::vector<Candidate> const& candidates, ModelSelectionTarget const& target,
                     std::vector<CandidatePosterior> const& posteriors, SelectionReport& selection);

/// A final threshold far above the noise floor.
Findings check_threshold(SelectionReport const& selection);

/// What a candidate leaves of the record at the heaviest mode near its particles, scored and tested as a fit is; findings name
/// the model. Nothing where the likelihood has no mode there.
FitCheck check_candidate(Session& session, Candidate const& candidate, CandidatePosterior const& posterior);

/// Draws of a candidate's posterior once more with the next finer solver than `solver`, by which they and `modes` are: does any
/// parameter move by more than half an sd? leads: it is the most probable one, of which this is an error. Nothing where the solver
/// is exact or nothing is solved, and where there are no draws.
Findings check_solver(Session& session, Candidate const& candidate, Draws const& draws, std::vector<Mode> const& modes,
                      SolverSettings const& solver, std::uint64_t seed, bool leads);

/// Particles of a model once more with the next finer solver: their distances must not be those of the integrator. An error where
/// they change by as much as the threshold.
Findings check_distances(SelectionTarget const& finer, int model, SelectionResult const& result, SolverSettings const& solver);

}  // namespace sysid
