// Instantiates the rules of model.hpp.
#include "grammar/model_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(model), Iterator, Context)
BOOST_SPIRIT_INSTANTIATE(decltype(function_definition), Iterator, Context)

}  // namespace sysid::grammar
