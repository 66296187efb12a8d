// Instantiates the rules of candidates.hpp.
#include "grammar/candidates_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(candidates), Iterator, Context)

}  // namespace sysid::grammar
