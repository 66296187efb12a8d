// Messages about numbers that nothing can be computed from, and about rows of two parts.
#pragma once
#include <string>

#include "check/message/subject.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid::errors {

/// E2112: `log_uniform(2, inf)`. spelling: of the argument.
Diagnostic argument_not_finite(Span span, std::string const& spelling, std::string const& distribution);
/// E2015: `parameter m = inf`.
Diagnostic value_not_finite(Span span, Subject const& what);
/// E4116: rows that two parts of a record have in common, neither being part of the other.
/// cure: "begin `test` at row 3".
Diagnostic parts_overlap(Span second, Span first, std::string const& later, std::string const& earlier, int from, int to,
                         std::string const& cure);

/// What is meant in place of a size that is no number: a unit, the time, the argument of a function; empty where that is unknown.
std::string instead_of_size(ast::Declared const& declared);

}  // namespace sysid::errors
