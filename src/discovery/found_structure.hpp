// Structures of a discovery: one support for each equation, what becomes a model.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "regression/discovery.hpp"

namespace sysid {

struct FoundStructure {
  std::vector<regression::Support const*> equations;
  double score = 0;           // log probability, or log evidence where the selector knows no probabilities; summed over equations
  int of_regression = 0;      // its place in the regression's list, from 1; 0: it is not listed
  std::vector<double> inner;  // where a fit of parameters inside terms begins, SI; empty: at those of the source
  std::vector<Eigen::VectorXd> refined;  // per equation: coefficients of a search by simulation; empty: those of the supports
};

/// The structure that was chosen first, then the best of the others; each support as its equation lists it. Empty when an equation
/// was not found.
std::vector<FoundStructure> best_structures(regression::Discovery const& discovery, int most);

/// Whether simulation may use a term: not one that is not finite, zero or a multiple of another on the record, nor one that up to
/// three others give (a conserved sum). That it is a combination of many others, as any smooth function on a short range is, rules
/// it out of a regression on all terms, but not out of a structure of a few.
bool is_offered(regression::FoundEquation const& equation, std::size_t term);

/// "y', y, y^3"; of several equations "prey': prey, prey*predator; predator': ...".
std::string structure_text(CheckedDictionary const& dictionary, FoundStructure const& structure);

}  // namespace sysid
