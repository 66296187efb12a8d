// Result folders before the work begins: claimed and proved writable, kept when they are complete.
#pragma once
#include <filesystem>

#include "app/session/options.hpp"

namespace sysid {

/// Makes the folder ready and proves that it can be written. UserError when it holds results already and neither force nor resume
/// is asked for; IoError when it cannot be written: said before hours of sampling, not after.
void claim_results(std::filesystem::path const& folder, RunOptions const& options);

std::filesystem::path checkpoint_path(std::filesystem::path const& folder);

/// Whether a task ended there (a summary without a checkpoint).
bool complete(std::filesystem::path const& folder);

}  // namespace sysid
