// What a discovery found, as source text: a model for each structure, the data, a fit and a prediction.
#pragma once
#include <string>
#include <vector>

#include "app/experiments.hpp"
#include "app/found_structure.hpp"
#include "app/session.hpp"

namespace sysid {

struct FoundSource {
  Session const& session;
  Task const& task;
  DiscoverTask const& what;
  CheckedDictionary const& dictionary;
  std::vector<ExperimentData> const& data;
  regression::Discovery const& discovery;
  std::uint64_t seed = 0;

  /// A complete file whose paths start at the task's folder of results. structures: at least one; the first is the model that is
  /// fitted, several become a set of candidates with a selection.
  std::string text(std::vector<FoundStructure> const& structures) const;
};

}  // namespace sysid
