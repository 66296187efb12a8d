// How the call of a distribution is written whose arguments do not fit together, or that is written as in another language.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "syntax/ast.hpp"

namespace sysid {

/// Whether a call is.
using Valid = std::function<bool(ast::Call const&)>;

/// The call with one change to its numbers that makes it valid: bounds exchanged, or the sign of an argument removed; empty where
/// none does.
std::string corrected_call(ast::Call const& given, Valid const& valid);

/// `log_uniform(1,000, 1,000,000)` with its digits not grouped, where that makes as many valid arguments as it takes; else empty.
std::string without_grouped_digits(ast::Call const& call, std::size_t arguments, Valid const& valid);

/// Help about `gaussian(0, 10)`, `N(0, 10)`: a normal distribution under another name; empty for other calls.
std::string normal_of_others(ast::Call const& call);

}  // namespace sysid
