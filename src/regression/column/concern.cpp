// Which concerns end a discovery.
#include "regression/column/concern.hpp"

namespace sysid::regression {

bool fatal(Concern::Kind kind) { return kind <= Concern::Kind::nothing_left; }

bool any_fatal(Concerns const& concerns) {
  for (Concern const& concern : concerns)
    if (fatal(concern.kind)) return true;
  return false;
}

}  // namespace sysid::regression
