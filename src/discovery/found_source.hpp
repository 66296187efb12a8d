// What a discovery found, as source text: a model for each structure, the data, a fit and a prediction.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "discovery/found_structure.hpp"
#include "experiment/experiments.hpp"
#include "result/finding.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

struct FoundSource {
  CheckedFile const& file;
  std::filesystem::path folder;   // of the file, from which its data paths are relative
  std::filesystem::path results;  // of the task
  ExecutionOptions execution;
  Task const& task;
  DiscoverTask const& what;
  CheckedDictionary const& dictionary;
  std::vector<ExperimentData> const& data;
  regression::Discovery const& discovery;
  std::vector<double> inner;          // values of the dictionary's parameters inside terms, SI
  std::vector<double> noise_sd = {};  // per channel, SI, as the simulation has it; empty: as the regression took it
  std::vector<double> growth = {};    // per channel of the dictionary, SI: ValidatedChannel::growth; empty: 0
  std::uint64_t seed = 0;

  /// A complete file whose paths start at the task's folder of results. structures: at least one; the first is the model that is
  /// fitted, several become a set of candidates with a selection.
  std::string text(std::vector<FoundStructure> const& structures) const;
};

/// The source with what the discovery came to as comments above its first model: the verdict, then each finding that is no note.
std::string with_verdict(std::string const& source, std::string const& verdict, Findings const& findings);

}  // namespace sysid
