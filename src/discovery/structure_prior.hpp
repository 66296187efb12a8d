// The prior of a structure: few and simple terms are more probable.
#pragma once
#include <vector>

#include "check/checked/checked.hpp"
#include "regression/discovery.hpp"

namespace sysid {

/// What a term's simplicity is multiplied by for each factor, and for each function, that it has.
inline constexpr double simplicity_of_factor = 0.75, simplicity_of_function = 0.125;

/// In (0, 1]: 1 of a constant or a symbol, times 3/4 for each further factor (`x*y`, `x^2`, `abs(x)`), times 1/8 for each function
/// and for each quotient or power whose exponent is no small whole number (`sin(x)`, `x/(1 + x)`).
double simplicity(ast::Expression const& term);

/// Log odds that each term is in the equation, of those that are offered and not part of the target; 0 for all others.
///
///   P(term j) = min(1/2, w_j / (2 sum of w)),     w the simplicity
///
/// so that an equation has half a term on average, however many are offered.
std::vector<double> log_term_odds(std::vector<DictionaryTerm> const& terms, regression::FoundEquation const& equation);

/// The same for weights that are given; 0 for those that are 0.
std::vector<double> log_odds_of(std::vector<double> const& weights);

}  // namespace sysid
