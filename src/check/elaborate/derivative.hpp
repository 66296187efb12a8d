// The time derivative of an expression of numbers: what `displacement'` means where a part's input is bound to an expression.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "syntax/ast.hpp"

namespace sysid {

/// What a name of the flat model stands for when time passes.
struct OverTime {
  enum class Kind {
    moving,   // a state or an input: a prime more
    still,    // a parameter, a constant, a number
    time,     // the time itself
    defined,  // by `definition`, in terms of others
  };
  Kind kind = Kind::still;
  ast::Expression const* definition = nullptr;
};

/// d/dt by the rules for sums, products, quotients and constant powers; nothing where another operation is in the way. A number 0
/// where nothing moves. left: how many expressions may still be looked at, definitions included each time they occur; 0 and
/// nothing when that, or the stack, is not enough.
std::optional<ast::Expression> time_derivative(ast::Expression const& expression,
                                               std::function<std::optional<OverTime>(std::string const&)> const& motion_of,
                                               std::size_t& left);

}  // namespace sysid
