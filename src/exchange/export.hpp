// `sysid export`: results and models in the forms of other programs.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/session.hpp"
#include "exchange/stored_result.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The results that a folder holds: of one task, or of a run's.
struct ExportedResults {
  std::filesystem::path run;          // the folder that holds the folders of tasks
  std::vector<StoredResult> results;  // of one task, or of all, by name
  bool one_task = false;
  std::filesystem::path file;  // of which they are, as their timing.json has it; empty: unknown
};

/// UserError where the folder holds none, IoError where there is no folder or they cannot be read.
ExportedResults find_results(std::filesystem::path const& folder);

/// UserError where there is nothing to export, and where a file is there already and `force` is not given: before any work.
void require_exportable(ExportedResults const& results, bool force);

/// Writes each fit of the results as TASK.nc into its folder, InferenceData in NetCDF-4, with the predictions of its draws; of each
/// selection TASK_MODEL.nc per living candidate. session: of the .sysid file that the results are of; null: then the files hold
/// what the results hold themselves. draws: how many of them are simulated once more. Says on `out` what was written, with which
/// groups.
void export_netcdf(ExportedResults const& results, Session* session, int draws, std::ostream& out);

/// Writes fits as Stan programs, TASK.stan and TASK.data.json, into their folders of results. With results: of those fits, with the
/// solver that they settled on; without (null): of all fits of the session's file, with the solver that they state. All are written
/// or none: UserError as `stan_program`, and where a file is there already and `force` is not given.
void export_stan(Session& session, ExportedResults const* results, bool force, std::ostream& out);

/// The models of a text as it is written, each as one align* of amsmath behind a line that names it: equations, initial values,
/// definitions, observations, priors. Of a text that can be read.
std::string equations_latex(ast::File const& file);

}  // namespace sysid
