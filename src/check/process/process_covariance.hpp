// The covariance of a Gaussian process from its declaration: kernels, the inputs that they read, and hyper-parameters as given.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "check/units/quantity.hpp"
#include "core/text/diagnostic.hpp"
#include "gaussian_process/kernel.hpp"
#include "model/process.hpp"
#include "syntax/ast.hpp"

namespace sysid {

class Scope;

/// What stands in `gp(...)`: one covariance, and beside it what goes by name.
struct ProcessArguments {
  ast::Expression const* covariance = nullptr;
  std::map<std::string, ast::Argument const*> named;
};
/// known: the names that there are. Nothing after a diagnostic.
std::optional<ProcessArguments> process_arguments(ast::ProcessDefinition const& definition, std::vector<std::string> const& known,
                                                  Diagnostics& diagnostics);

/// A hyper-parameter as given: of which row of its kernel, for which column.
struct HyperParameterGiven {
  gaussian_process::HyperParameterRow const* row;
  int column;  // of the process's inputs; -1: of none
  Typed value;
};
/// By kernel, in the order of Process::kernels.
using HyperParametersGiven = std::vector<std::vector<HyperParameterGiven>>;

/// Kernels with the columns that they read, and the expression that joins them, into `process`; hyper-parameters, whose units
/// `resolve_units` makes out, into `given`. columns: of each declared input, of an input that stands for several lags one for each.
/// False after a diagnostic.
bool read_covariance(Scope& scope, ast::ProcessDefinition const& definition, ast::Expression const& covariance,
                     std::vector<std::vector<int>> const& columns, Process& process, HyperParametersGiven& given);

}  // namespace sysid
