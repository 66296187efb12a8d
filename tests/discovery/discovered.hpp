// Discoveries from texts that read the shipped records.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "app/running.hpp"

namespace sysid {

inline std::filesystem::path const discovery_models = std::filesystem::path(SYSID_SOURCE_DIR) / "models/discovery";
inline std::string const duffing = read_file(discovery_models / "duffing.sysid");

/// A text run beside the shipped records; its task is called `found`. Results stay as long as this.
struct Discovered {
  TemporaryFolder folder;
  RunResult result;
  nlohmann::json summary;
  std::filesystem::path place;  // of the results

  explicit Discovered(std::string const& text, RunOptions options = {}) {
    options.output = folder.path() / "results";
    result = run_text(discovery_models / "here.sysid", text, options);
    place = options.output / "found";
    summary = nlohmann::json::parse(read_file(place / "summary.json"));
  }
  /// The file that it wrote.
  std::filesystem::path source() const { return place / "found.sysid"; }
};

}  // namespace sysid
