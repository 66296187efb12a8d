// Instantiates the rules of expression.hpp that expression_def.hpp defines.
#include "grammar/expression_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(expression), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(call), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(distribution), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(argument), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(reference), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(declared), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(declared_parameter), Iterator, Context)

}  // namespace sysid::grammar
