// `sysid check`: the checks of a file that need no sampling.
#pragma once
#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "result/check_page.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Structure of all models and dictionaries, the data of all tasks, and for each fit what prior draws predict, which step they need
/// and what the data can tell about the parameters. What is wrong with data or settings is added to `diagnostics`; tasks without
/// usable data are left at that. `unreadable` is set when the only errors are files that cannot be read.
struct CheckResult {
  CheckPage page;
  Diagnostics diagnostics;
  bool unreadable = false;
};
CheckResult check_file(Session& session);

/// Whether draws of the prior predict channels of another size than was measured, as a wrong unit makes them: what a fit asks
/// before it searches (`prior_far_from_data`). Nothing of priors that cannot be drawn from.
Findings check_prior_size(Session& session, FitTask const& what, std::vector<ExperimentData> const& data);

/// Equations, unknowns and everything declared, in the user's words where the text has them. flat: the models with their parts
/// written out (CheckedFile::tree), for what stands in modules.
ModelPage describe_structure(ast::File const& written, ast::File const& flat, Model const& model);

/// States and their channels, the terms of each equation with the units of their coefficients, what was left out and why.
DictionaryPage describe_dictionary(CheckedDictionary const& dictionary);

/// Rows, gaps, rates and the band of each input.
CoveragePage describe_coverage(ExperimentData const& data, DataBlock const& block, StartRule start, Model const& model);

/// Simulates prior draws of a fit with its input and fills the page's prior, information and findings.
void run_preflight(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, PreflightPage& page);

/// Whether faster methods than the stated one solve such equations.
Findings check_method(Session const& session, FitTask const& what);

}  // namespace sysid
