// Text of the user as HTML: escaped, and equations as a printed page shows them.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// `<`, `>`, `&` and `"` as entities.
std::string escape(std::string_view text);

/// An equation of the language for the eye: names slanted, powers raised, primes as primes, the user's names untouched. HTML.
std::string typeset(std::string_view equation);

}  // namespace sysid
