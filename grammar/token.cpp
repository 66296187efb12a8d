// Instantiates the rules of token.hpp.
#include "grammar/token_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(name), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(text), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(plain_number), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(path), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(element), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(equals), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(tilde), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(opening_brace), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(end_of_statement), Iterator, Context)

}  // namespace sysid::grammar
