// A task's folder of results read back: its summary and all that its draws hold.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "result/draws.hpp"

namespace sysid {

struct StoredResult {
  std::filesystem::path folder;
  nlohmann::ordered_json summary;

  std::string task() const { return summary.value("task", std::string()); }
  std::string what() const { return summary.value("what", std::string()); }
  bool is(std::string_view verb) const { return summary.value("verb", std::string()) == verb; }
  std::uint64_t seed() const { return summary.value("seed", std::uint64_t{0}); }
};

/// UserError where summary.json is that of no task or of an older version, IoError where it cannot be read.
StoredResult read_stored_result(std::filesystem::path const& folder);

/// Draws of a fit, parameters and what derives from them, under the user's names and in declared units. UserError where they do
/// not belong to the summary or there are none.
Draws stored_draws(StoredResult const& stored);

}  // namespace sysid
