// Defaults for the optional parts of a target.
#include "likelihood/target.hpp"

#include "core/text/diagnostic.hpp"

namespace sysid {

double Target::log_likelihood_gradient(std::span<double const>, std::span<double>, Ledger&) const {
  throw InternalError("a gradient of a target that has none");
}

}  // namespace sysid
