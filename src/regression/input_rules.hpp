// Whether another rule between the samples of an input explains an equation better.
#pragma once
#include <optional>
#include <span>

#include "regression/discovery.hpp"

namespace sysid::regression {

/// One projection for each input that the equation reads and each other rule, stated for all experiments; least squares with all
/// terms that were used. Nothing, or the rule of the least sum of squares: less than 0.8 of the stated rule's, and by successive
/// sixteenths of the rows less in the mean by more than 3.2 standard errors. A concern `other_rule`.
///
/// equation: of the dictionary, found. columns: its own, as projected.
std::optional<Concern> better_rule(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                                   int equation, Columns const& columns, FoundEquation const& found);

}  // namespace sysid::regression
