// How much of an evidence is owed to the width of a prior.
#pragma once
#include <optional>
#include <string>

namespace sysid {

/// The evidence as it would be with a wider or narrower prior.
struct PriorWidth {
  std::string parameter;         // whose prior it is; empty: of all that have a width
  double factor = 1;             // on its width
  std::optional<double> change;  // of the log evidence, nats; nothing where the draws do not reach far enough to tell
  double error = 0;              // one standard error of it
};

}  // namespace sysid
