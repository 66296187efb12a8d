// The evidence of a model as a number with what is known of its error.
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "core/setting/evidence_method.hpp"

namespace sysid {

/// A check of Laplace's approximation by weighted draws, where it is the result.
struct SampledEvidence {
  enum class State { none, known, unknown };  // not computed; to `error`; the draws cannot tell
  State state = State::none;
  double above = 0;      // log_evidence would be larger by this
  double error = 0;      // one standard error
  double effective = 0;  // number of equally weighted draws that they are worth
  std::uint64_t draws = 0;

  /// By more than a tenth, to which the number is written, and by more than chance.
  bool differs() const { return state == State::known && std::fabs(above) > 0.1 && std::fabs(above) > 2 * error; }
};

struct Evidence {
  std::optional<double> log_evidence;  // nats, of densities in declared units
  std::string reason;                  // why there is none
  /// How far the density is from normal: by the axes of the modes' ellipsoids, one by one, log_evidence would be larger by this.
  double along_axes = 0;
  int modes = 0;               // that it is the sum over
  bool of_likelihood = false;  // there is none by the nature of the fit
  SampledEvidence sampled = {};
  EvidenceMethod method = EvidenceMethod::laplace;  // that gave log_evidence
  std::optional<double> error = {};                 // one standard error, nats; Laplace's approximation has none
  double effective = 0;                             // number of independent draws that the draws of the estimate are worth
  std::uint64_t simulations = 0;                    // that the estimate took
  std::optional<double> laplace = {};               // Laplace's approximation, whichever method gave log_evidence
  std::string without_laplace = {};                 // why there is none
  std::string doubt = {};                           // why log_evidence may be wrong by more than its error; empty: it is confirmed

  /// Whether Laplace's approximation is off by more than two tenths and by more than chance.
  bool disagrees_with_laplace() const {
    return method != EvidenceMethod::laplace && log_evidence && laplace && std::fabs(*laplace - *log_evidence) > 0.2 &&
           std::fabs(*laplace - *log_evidence) > 2 * error.value_or(0);
  }
};

}  // namespace sysid
