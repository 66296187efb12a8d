// The evidence of a model as a number with what is known of its error.
#pragma once
#include <optional>
#include <string>

namespace sysid {

struct Evidence {
  std::optional<double> log_evidence;  // nats, of densities in declared units
  std::string reason;                  // why there is none
  /// How far the density is from normal: by the axes of the modes' ellipsoids, one by one, log_evidence would be larger by this.
  double along_axes = 0;
  int modes = 0;               // that it is the sum over
  bool of_likelihood = false;  // there is none by the nature of the fit
};

}  // namespace sysid
