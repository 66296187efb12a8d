// Draws of an earlier run, read back from its files: what `predict` works from when the fit is not part of this run.
#pragma once
#include <filesystem>

#include "app/session/session.hpp"

namespace sysid {

/// The fit task's draws and settings: from this run, else from its result folder. UserError when there are none, or the stored ones
/// are of another model.
FittedModel const& fitted_model(Session& session, int fit);

/// The rows of a file of draws: columns of the sampler, `own`, which come first there, then those of the parameters by the user's
/// names. UserError where one is missing, IoError where the file cannot be read.
std::vector<std::vector<double>> read_draws_rows(std::filesystem::path const& path, std::vector<std::string> const& own,
                                                 std::vector<std::string> const& parameters);

/// A file in the form of Stan's CSV.
Chain read_chain(std::filesystem::path const& path, std::vector<std::string> const& parameters);

/// summary.json and draws_N.csv of a folder. parameters: names the draws must have, in order.
FittedModel read_fitted(std::filesystem::path const& folder, std::vector<std::string> const& parameters);

/// What a select task left, per candidate: from this run, else from its result folder. UserError as for a fit.
std::vector<SelectedCandidate> const& selected_candidates(Session& session, int select);

}  // namespace sysid
