// The evidence of a model as a number with what is known of its error.
#pragma once
#include <cmath>
#include <optional>
#include <string>

namespace sysid {

/// A second computation, by weighted draws.
struct SampledEvidence {
  enum class State { none, known, unknown };  // not computed; to `error`; the draws cannot tell
  State state = State::none;
  double above = 0;  // log_evidence would be larger by this
  double error = 0;  // one standard error

  /// By more than two tenths, and by more than chance.
  bool differs() const { return state == State::known && std::fabs(above) > 0.2 && std::fabs(above) > 2 * error; }
};

struct Evidence {
  std::optional<double> log_evidence;  // nats, of densities in declared units
  std::string reason;                  // why there is none
  /// How far the density is from normal: by the axes of the modes' ellipsoids, one by one, log_evidence would be larger by this.
  double along_axes = 0;
  int modes = 0;               // that it is the sum over
  bool of_likelihood = false;  // there is none by the nature of the fit
  SampledEvidence sampled = {};
};

}  // namespace sysid
