// Claiming result folders.
#include "app/results.hpp"

#include "core/files.hpp"
#include "report/result.hpp"

namespace sysid {

std::filesystem::path checkpoint_path(std::filesystem::path const& folder) { return folder / "checkpoint.cbor"; }

bool complete(std::filesystem::path const& folder) {
  return std::filesystem::exists(folder / "summary.json") && !std::filesystem::exists(checkpoint_path(folder));
}

void claim_results(std::filesystem::path const& folder, RunOptions const& options) {
  prepare_result(folder, options.force || options.resume);
  if (!options.resume) remove_file(checkpoint_path(folder));
  // A byte, since a full disk takes empty files.
  write_file(folder / "claim", ".");
  remove_file(folder / "claim");
}

}  // namespace sysid
