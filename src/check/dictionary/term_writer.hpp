// What the lists of a dictionary stand for, still as text: families written out, the coefficient before a term taken off.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "check/dictionary/generators.hpp"
#include "check/expression/scope.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

struct WrittenTerm {
  ast::Expression tree;     // without the coefficient
  std::string text;         // of it
  std::string coefficient;  // the parameter that stood before it; empty: none
};

class TermWriter {
 public:
  TermWriter(Scope& scope, Diagnostics& diagnostics) : scope_(scope), diagnostics_(diagnostics) {}

  /// item: `abs(y')*y'`, `k*y`, `polynomial(y, y', degree = 3)`, `x*polynomial(y, degree = 2)`: products are multiplied out over
  /// families. free: parameters that are looked for. Empty when a diagnostic was added.
  std::vector<WrittenTerm> write(ast::Expression const& item, std::set<std::string> const& free);

 private:
  std::vector<ast::Expression> expanded(ast::Expression const& item);
  // `polynomial(y, degree = 3)` inside a term that is no product; null for none.
  ast::Call const* family_inside(ast::Expression const& item) const;
  bool is_lag(ast::Call const& call) const;
  /// `lags(y, 1..3)`, or `lag` with a range: each sample by itself. Anything else as it is.
  std::vector<ast::Expression> past(ast::Call const& call, ast::Expression const& item);
  std::optional<int> whole(ast::Expression const& tree);
  std::vector<ast::Expression> family(ast::Call const& call, GeneratorRow const& row, Span place);
  /// Nothing where a free parameter stands otherwise than as one factor.
  std::optional<WrittenTerm> without_coefficient(ast::Expression tree, std::set<std::string> const& free);

  Scope& scope_;
  Diagnostics& diagnostics_;
};

}  // namespace sysid
