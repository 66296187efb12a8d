// Instantiates the unit rules of expression.hpp.
#include "grammar/unit_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(unit), Iterator, Context)

}  // namespace sysid::grammar
