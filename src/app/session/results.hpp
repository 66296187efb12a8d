// Folders of results before the work begins: reserved, checked to be writable, and kept if they are complete.
#pragma once
#include <filesystem>

#include "app/session/options.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {

/// Makes the folder ready and proves that it can be written. UserError when it holds results already and neither force nor resume
/// is asked for; IoError when it cannot be written: said before hours of sampling, not after.
void claim_results(std::filesystem::path const& folder, RunOptions const& options);

std::filesystem::path checkpoint_path(std::filesystem::path const& folder);

/// Whether a task ended there (a summary without a checkpoint).
bool complete(std::filesystem::path const& folder);

/// Whether a summary holds the fields that its readers decide by. Json: an object, in the order of its keys or not.
template <class Json>
bool has_deciding_fields(Json const& summary) {
  return summary.contains("verb") && summary["verb"].is_string() && summary.contains("prediction_rule") &&
         summary["prediction_rule"].is_string() && summary.contains("measured_past") && summary["measured_past"].is_boolean() &&
         summary.contains("lags") && summary["lags"].is_number_integer();
}

/// For results in that folder without these fields.
UserError older_version(std::filesystem::path const& folder);

}  // namespace sysid
