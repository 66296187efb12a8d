// Statements of the user's models as HTML: formulas.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// Statements of a model, equations above all, as displayed MathML; what is none stays the text it is, in `<code>`.
std::vector<std::string> typeset(std::vector<std::string> const& statements);

}  // namespace sysid
