// Names that a Stan program may give.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// A name as Stan may call it: letters, digits and underscores, no word of Stan or C++, no name of a function of Stan's library nor
/// one that ends as those of its distributions do; `taken` gets it. Where it is taken, a number stands behind it.
///   reserved names       Stan Reference Manual, section "Variables", of the present version and of 2.21
///   names of functions   Stan 2.21, lang/function_signatures.h, and single words that came after it. The present version would
///                        let a variable have them
std::string stan_identifier(std::string const& name, std::vector<std::string>& taken);

}  // namespace sysid
