// Text of the user as HTML: escaped, and statements of models as formulas.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// `<`, `>`, `&` and `"` as entities.
std::string escape(std::string_view text);

/// A statement of a model, an equation above all, as displayed MathML; what is none stays the text it is, in `<code>`.
std::string typeset(std::string_view statement);

}  // namespace sysid
