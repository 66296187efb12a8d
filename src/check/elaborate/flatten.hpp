// One model with its parts, vectors and matrices to a model of numbers: names become `spring.k` and `q[2]`.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "check/elaborate/array.hpp"
#include "check/elaborate/environment.hpp"
#include "check/elaborate/whole_number.hpp"

namespace sysid {

/// A model with its arguments known.
struct Instance {
  ModelEntry model;
  WholeNumbers arguments;

  /// "bouc_wen(n = 2)": what tables and messages call it.
  std::string display() const;
};

/// The arguments of a model from those given by name, else their defaults; what is no argument of it is left to the caller.
/// Nothing, with diagnostics, when one is missing or no whole number. use: where the model is used; known: names there.
std::optional<WholeNumbers> model_arguments(ast::Model const& model, std::vector<ast::Argument> const& given, Span use,
                                            WholeNumbers const& known, Diagnostics& diagnostics);

struct FlatModel {
  ast::Model tree;
  std::map<std::string, Shape> shapes;  // of the names that are no numbers
};

/// The instances of the model's parts, parts of parts included; what is wrong with them is left to `flatten`.
std::vector<Instance> parts_of(Instance const& instance);

/// Nothing when a diagnostic was added. left: nodes of expressions that the models of a file may still be written out into.
std::optional<FlatModel> flatten(Instance const& instance, std::size_t& left, Diagnostics& diagnostics);

}  // namespace sysid
