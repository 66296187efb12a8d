// Results as files for ArviZ and xarray, beside what they were made of.
#pragma once
#include <ostream>

#include "exchange/inference_data.hpp"
#include "exchange/results_folder.hpp"

namespace sysid {

/// UserError where there is nothing to export, and where a file is there already and `force` is not given: before any work.
void require_exportable(ResultsFolder const& results, bool force);

/// Writes each fit of the results as TASK.nc into its folder, InferenceData in NetCDF-4, with the predictions of its draws; of each
/// selection TASK_MODEL.nc per living candidate. session: of the .sysid file that the results are of; null: then the files hold
/// what the results hold themselves. draws: how many of them are simulated once more. Says on `out` what was written, with which
/// groups, and what was left out.
void export_netcdf(ResultsFolder const& results, Session* session, int draws, std::ostream& out);

/// What the file of a fit would hold.
InferenceData fit_data(StoredResult const& stored, Session* session, int draws);

}  // namespace sysid
