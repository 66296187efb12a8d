// Candidates before a selection by likelihood: the modes of each, and a solver that is fine enough for them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/selection/candidate.hpp"
#include "result/mode.hpp"
#include "search/journal.hpp"

namespace sysid {

struct SearchedCandidate {
  std::vector<Mode> modes;  // by falling share; none of a model without parameters
  SolverSettings solver;    // under which they are
  std::string excluded;     // why it has no finite likelihood; empty: it has
};

/// The search of a fit for each candidate, over its priors; then, unless the task states how fine the solver is, finer ones until
/// they leave the modes where they are. Findings name the candidates. Nothing when interrupted; the journal keeps the searches.
std::optional<std::vector<SearchedCandidate>> search_candidates(Session& session, std::vector<Candidate> const& candidates,
                                                                std::uint64_t seed, Journal& journal, Findings& findings);

}  // namespace sysid
