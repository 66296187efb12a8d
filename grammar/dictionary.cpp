// Instantiates the rules of dictionary.hpp.
#include "grammar/dictionary_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(dictionary), Iterator, Context)

}  // namespace sysid::grammar
