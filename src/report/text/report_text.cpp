// Evidence and severity in words.
#include "report/text/report_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace sysid {

std::string evidence_text(Evidence const& evidence) {
  constexpr double rough = 0.5;  // nats: below, no comparison turns on it
  if (!evidence.log_evidence) return evidence.of_likelihood ? "" : fmt::format("no log evidence: {}", evidence.reason);
  SampledEvidence const& sampled = evidence.sampled;
  std::string const doubt =
      sampled.differs() ? fmt::format(", approximate: weighted draws change it by {:+.2f}", sampled.above)
      : sampled.state == SampledEvidence::State::unknown
          ? fmt::format(", approximate: weighted draws do not confirm it{}",
                        std::fabs(evidence.along_axes) < rough
                            ? ""
                            : fmt::format("; integration along its axes changes it by {:+.1f}", evidence.along_axes))
      : sampled.state == SampledEvidence::State::none && std::fabs(evidence.along_axes) >= rough
          ? fmt::format(", approximate: integration along its axes changes it by {:+.1f}", evidence.along_axes)
          : "";
  return fmt::format("log evidence {:.1f} (Laplace{})", *evidence.log_evidence, doubt);
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace sysid
