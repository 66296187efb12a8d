// The results of a discovery other than its terms: findings, the source text of the model that was found, the verdict.
#pragma once
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "discovery/found_source.hpp"
#include "discovery/found_structure.hpp"
#include "discovery/simulation_validation.hpp"
#include "regression/discovery.hpp"
#include "result/discovery.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Of each equation, in the light of the simulation where there was one. described: the equations in words.
void add_regression_findings(CheckedDictionary const& dictionary, regression::Discovery const& found,
                             std::vector<DiscoveredEquation> const& described, Validation const* validation, Findings& findings);

/// Records whose steps were unequal, by name.
Findings interpolation_findings(std::vector<std::string> const& records, bool simulated);

/// Records whose missing samples were filled in, by name.
Findings filling_findings(std::vector<std::string> const& records, bool simulated);

/// Parameters inside terms that the record puts where their prior is not: the fit is by the likelihood alone.
void add_prior_findings(CheckedDictionary const& dictionary, DiscoveryReport const& discovery, Findings& findings);

/// Per channel of the dictionary, SI; 0 where nothing was simulated.
std::vector<double> simulated_noise(CheckedDictionary const& dictionary, DiscoveryReport const& discovery);

/// Into `discovery`. Written are structures that the program takes, one after the other: one may be no model that can be simulated.
void add_found_source(FoundSource const& source, std::vector<FoundStructure> const& structures, DiscoveryReport& discovery,
                      Findings& findings);

/// By simulation where that has validated a structure.
std::vector<std::string> found_equations(DiscoveryReport const& discovery);

/// "m*y'' = -k*y; the form is decided ...; pass".
std::string discovery_headline(DiscoveryReport const& discovery, std::vector<std::string> const& equations,
                               Findings const& findings);

}  // namespace sysid
