// What a discovery found, as source text: a model for each structure, the data, a fit and a prediction.
#pragma once
#include <string>
#include <vector>

#include "app/experiments.hpp"
#include "app/session.hpp"
#include "regression/discovery.hpp"

namespace sysid {

/// One support for each equation of the dictionary: what becomes a model.
struct FoundStructure {
  std::vector<regression::Support const*> equations;
  double score = 0;  // log probability, or log evidence where the selector knows no probabilities; summed over equations
};

/// The structure that was chosen first, then the best of the others; each support as its equation lists it. Empty when an equation
/// was not found.
std::vector<FoundStructure> best_structures(regression::Discovery const& discovery, int most);

/// Names of the coefficients of one equation's terms in the source: the parameter where one is named, else `a3`, the third term of
/// the first equation.
std::vector<std::string> coefficient_names(CheckedDictionary const& dictionary, int equation);

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
