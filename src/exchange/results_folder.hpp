// Which results a folder contains, and of which tasks of a file.
#pragma once
#include <filesystem>
#include <vector>

#include "app/session/session.hpp"
#include "exchange/stored_result.hpp"

namespace sysid {

/// The results that a folder holds: of one task, or of a run's.
struct ResultsFolder {
  std::filesystem::path run;          // the folder that holds the folders of tasks
  std::vector<StoredResult> results;  // of one task, or of all, by folder
  bool one_task = false;
  std::filesystem::path file;  // of which they are, as their timing.json has it; empty: unknown
};

/// UserError where the folder holds none, IoError where there is no folder or they cannot be read.
ResultsFolder find_results(std::filesystem::path const& folder);

/// The index of the task whose results these are, which the session finds in their folder from now on, whatever its name.
/// UserError where the file has no such task.
int find_task(Session& session, StoredResult const& stored);

}  // namespace sysid
