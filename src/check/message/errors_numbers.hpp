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
/// A range of a data block, both ends included.
struct NamedRows {
  std::string name;
  int first = 0, last = 0;
  Span span;
};
/// E4116: rows that two parts of a record have in common, where neither lies inside the other, or both are the same.
Diagnostic parts_overlap(NamedRows const& later, NamedRows const& earlier);

/// E2701: a size of what is declared that is no number, with what is meant in its place: a unit, the time, the argument of a
/// function.
Diagnostic size_needed(ast::Declared const& declared, std::size_t which);

}  // namespace sysid::errors
