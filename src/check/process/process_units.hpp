// Units of a Gaussian process: of its values and inputs, as far as arguments and hyper-parameters determine them.
#pragma once
#include <optional>
#include <vector>

#include "check/process/process_covariance.hpp"
#include "core/numeric/unit.hpp"

namespace sysid {

/// The unit of a value, where it has one that is known.
std::optional<Unit> known_unit(Typed const& value);

/// Hyper-parameters of `process` in SI, and the unit of its values. columns: what is known of the unit of each input of it. False
/// after a diagnostic.
bool resolve_units(Scope& scope, ast::ProcessDefinition const& definition, HyperParametersGiven const& given,
                   std::vector<std::optional<Unit>> const& columns, Process& process);

}  // namespace sysid
