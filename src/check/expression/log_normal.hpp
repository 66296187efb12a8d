// Arguments of a log-normal distribution that may be those of other languages.
#pragma once
#include <string>

#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "model/model.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// `log(x)`, `ln(x)`.
bool is_logarithm(ast::Expression const& value);

/// An argument that gives the place of a log-normal distribution, with its name.
struct PlaceOfLogarithm {
  std::string text;
  bool median = false;
};

/// `log_mean = 3`; of `log(x)` it is `median = x`, for what has a unit has no logarithm. Where `log(x/K)` is of a pure number and
/// the quantity is not, it is `log_mean = log(x/K)`.
PlaceOfLogarithm mean_of_logarithm(Scope& scope, ast::Expression const& value, Quantity const& variate);

/// `lognormal(log(x), sigma)` of Stan, R, NumPy and PyMC, where both arguments are of the logarithm: how it is written here. Empty
/// where it is written as here but for the name.
errors::LogNormalOfOthers log_normal_of_others(Scope& scope, ast::Call const& call, Quantity const& variate);

}  // namespace sysid
