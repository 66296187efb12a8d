// What the regression of a discovery found, in the words of the file.
#pragma once
#include <vector>

#include "check/checked/checked.hpp"
#include "regression/discovery.hpp"
#include "result/discovery.hpp"

namespace sysid {

struct DiscoveryInWords {
  DiscoverTask const& what;
  CheckedDictionary const& dictionary;
  std::vector<double> const& inner;     // values of the parameters inside terms, SI
  std::vector<double> const& inner_sd;  // empty: not known
};

/// Numbers in declared units; without what simulation and held-out rows say.
DiscoveryReport described_discovery(DiscoveryInWords const& of, regression::Discovery const& found,
                                    regression::SelectorRow const& selector);

}  // namespace sysid
