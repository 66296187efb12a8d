// Runs whole files and reads what they wrote, for tests of what the numbers mean.
#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "../app/running.hpp"

namespace sysid {

struct Fitted {
  int exit = 0;
  std::map<std::string, nlohmann::json> summary;  // by task
  std::string out, notices;

  nlohmann::json const& of(std::string const& task, std::string const& parameter) const {
    return summary.at(task).at("parameters").at(parameter);
  }
  bool found(std::string const& task, std::string const& code) const {
    for (auto const& finding : summary.at(task).at("findings"))
      if (finding.at("code") == code) return true;
    return false;
  }
};

/// data: files written beside the text, by name. The text's own simulate tasks write to `results/NAME/FILE`, relative to the text.
inline Fitted run_file(std::string const& text, RunOptions options = {}, std::map<std::string, std::string> const& data = {}) {
  TemporaryFolder folder;
  for (auto const& [name, bytes] : data) write_file(folder.path() / name, bytes);
  options.output = folder.path() / "results";
  RunResult const result = run_text(folder.path() / "case.sysid", text, options);
  Fitted fitted{result.exit, {}, result.out, result.notices};
  for (auto const& task : std::filesystem::directory_iterator(options.output))
    if (std::filesystem::exists(task.path() / "summary.json"))
      fitted.summary[task.path().filename().string()] = nlohmann::json::parse(read_file(task.path() / "summary.json"));
  return fitted;
}

/// The Duffing case with its own data made afresh from the run's seed. Its chains are as long as their checks need: an effective
/// size of 400.
inline std::string duffing_text() {
  std::string text = read_file(std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid");
  text = with(text, "file    \"duffing_1pct.csv\"", "file    \"results/truth/duffing_1pct.csv\"");
  return with(text, "samples = 25000, burn_in = 5000, thin = 10", "samples = 5000, burn_in = 1500, thin = 5");
}

inline RunOptions seeded(std::uint64_t seed) {
  RunOptions options;
  options.seed = seed;
  return options;
}

}  // namespace sysid
