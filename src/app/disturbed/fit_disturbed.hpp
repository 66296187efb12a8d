// `fit --with-disturbance`: the fits of a file as they are written and with a disturbance that nobody measured, side by side.
#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "app/disturbed/changed_file.hpp"
#include "app/disturbed/explained_share.hpp"
#include "app/session/session.hpp"

namespace sysid {

/// What a fit needs to be given a disturbance, once its results are there.
struct DisturbanceFound {
  std::vector<DisturbedEquation> equations;
  std::vector<DisturbanceSize> sizes;
};

/// Runs the fits of the file, keeping results that are complete; then each once more with a disturbance, in a file that is written
/// beside its results as `with_disturbance.sysid`; then says which of both the record prefers and what the disturbance changes.
/// UserError with its place where no model of a fit can have a disturbance.
ExitCode fit_with_disturbance(Source const& source, CheckedFile const& file, RunOptions const& options, Progress& progress,
                              std::ostream& out, std::ostream& notices);

/// Of a fit of which results are there.
DisturbanceFound find_disturbance(Session& session, Task const& fit);

/// The evidence of both fits, what the disturbance is, and what it changes. folders: of the results without and with it. The fit
/// with it is not preferred, whatever its evidence, where a fault of the record, a missing term or what the equations explained
/// stands behind the disturbance.
std::string disturbance_words(std::filesystem::path const& without, std::filesystem::path const& with,
                              std::vector<DisturbedEquation> const& equations, ExplainedShares const& shares);

/// At the draws of the fit itself and of those in `with`.
ExplainedShares explained_shares(Session& session, Task const& fit, std::filesystem::path const& with);

}  // namespace sysid
