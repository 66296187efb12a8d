// Instantiates the rules of data.hpp.
#include "grammar/data_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(data), Iterator, Context)

}  // namespace sysid::grammar
