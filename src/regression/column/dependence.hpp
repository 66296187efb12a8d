// Dependent columns: terms that are zero, multiples of others or sums of others; and those that are nearly dependent.
#pragma once
#include <string>
#include <vector>

#include "regression/column/columns.hpp"
#include "regression/column/concern.hpp"
#include "regression/column/dictionary.hpp"

namespace sysid::regression {

struct Usable {
  std::vector<int> terms;  // rising: linearly independent, finite, not zero
  Concerns concerns;       // one for each term left out
};

/// Terms are taken one after the other, those with `always` first, then in the user's order; one whose scaled column is, to 1e-8 of
/// its length, a sum of those already taken is left out.
Usable independent_terms(Equation const& equation, Columns const& columns);

/// Groups of the kept terms behind a condition index above 100 of their scaled columns, by Belsley, Kuh and Welsch's (1980)
/// variance proportions above one half.
Concerns near_dependence(Equation const& equation, Columns const& columns, std::vector<int> const& terms);

/// 1 / (1 - R^2) of each of `terms` on the others.
std::vector<double> variance_inflation(Columns const& columns, std::vector<int> const& terms);

/// "`y`, `y^3` and `abs(y)*y`"
std::string names_of(Equation const& equation, std::vector<int> const& terms);

}  // namespace sysid::regression
