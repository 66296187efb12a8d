// Whether a data block serves the model of a task: inputs, channels, units, rules between samples, constants.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// What the models and dictionaries of a file declare, whether they passed their own check or not: a block may serve several
/// models.
struct DeclaredNames {
  std::set<std::string> inputs, channels, parameters;
  bool all = true;  // otherwise a model could not be written out in numbers, and may have any name
};
DeclaredNames declared_names(ast::File const& file);

/// Whether the block says when its rows were taken and what inputs do between them, as far as the model's dynamics ask for it.
/// Without a model: as continuous time does.
void check_between_samples(DataBlock const& block, Model const* model, Diagnostics& diagnostics);

/// Whether the block serves a model: every input bound, some channel measured, no input or channel that no model of the file has,
/// units of one kind, input derivatives only where they exist. noun: what messages call it, "model" or "dictionary"; use: the place
/// of the task that brings the two together.
void check_binding(DataBlock const& block, Model const& model, std::string const& noun, DeclaredNames const& declared, Span use,
                   Diagnostics& diagnostics);

/// The constants of a block as values of a model's parameters, SI, [parameters]; absent where it fixes none. A constant fixes a
/// per-experiment parameter; one that no model of the file has is an error, and so is a per-experiment parameter that has neither
/// prior nor value nor constant.
std::vector<std::optional<double>> check_constants(DataBlock const& block, Model const& model, DeclaredNames const& declared,
                                                   Span use, Diagnostics& diagnostics);

}  // namespace sysid
