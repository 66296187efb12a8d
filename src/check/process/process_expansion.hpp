// A Gaussian process that stands in equations: `within` and `terms` beside its covariance make it a finite sum of known functions.
#pragma once
#include <optional>
#include <vector>

#include "check/process/process_covariance.hpp"
#include "model/expansion.hpp"

namespace sysid {

class Scope;

/// Whether the declaration asks for a finite sum.
bool is_expanded(ast::ProcessDefinition const& definition);

/// How many coefficients the sum will have; 0 where the declaration does not tell, which `expand` then says.
int coefficient_count(ast::ProcessDefinition const& definition);

/// The sum, without applications. process: with kernels whose hyper-parameters are settled, one column for each input;
/// coefficients: `coefficient_count` parameters of the model. Nothing after a diagnostic.
std::optional<Expansion> expand(Scope& scope, ast::ProcessDefinition const& definition, ProcessArguments const& arguments,
                                Process process, std::vector<int> coefficients);

}  // namespace sysid
