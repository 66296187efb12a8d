// Instantiates the rules of task.hpp.
#include "grammar/task_def.hpp"

namespace sysid::grammar {

BOOST_SPIRIT_INSTANTIATE(decltype(task), Iterator, Context)

}  // namespace sysid::grammar
