// Whether a difference equation lacks a term that its dictionary does not have.
#pragma once
#include <optional>
#include <span>

#include "data/experiment.hpp"
#include "regression/discovery.hpp"

namespace sysid::regression {

/// The one term, of powers up to the fifth, absolute values and products of the samples that the equation's terms read, with which
/// it describes the record far better, n rows and J terms tried:
///
///   n/2 log(squares without/squares with) - 1/2 log n - log J > 10                                                    Schwarz 1978
///
/// and by ten more than any term of the dictionary that was not chosen. An input that is white leaves residuals that are white and
/// correlated with no sample, whatever function of it is missing: neither whiteness nor correlations show it. found: equation
/// `equation` of the dictionary, in discrete time. most_numbers: rows times columns; where there would be more no products are
/// tried, or nothing. Nothing where the equation leaves only rounding, or the method was interrupted.
std::optional<Concern> outside_term(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                                    int equation, FoundEquation const& found, double most_numbers = 2e7);

}  // namespace sysid::regression
