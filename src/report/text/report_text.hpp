// Short texts that every writer of a report shares.
#pragma once
#include <string>
#include <string_view>

#include "core/text/diagnostic.hpp"
#include "result/evidence.hpp"

namespace sysid {

/// "293.72 ± 0.02", or "293.7" where no error is known.
std::string evidence_number(double log_evidence, std::optional<double> error);
/// "log evidence 293.72 ± 0.02 (importance sampling)"; with what its axes say where that is more than half a nat, or why there is
/// none. Empty for a fit of the likelihood alone, which nobody expects to have one.
std::string evidence_text(Evidence const& evidence);

/// "error", "warning", "note".
std::string_view severity_word(Severity severity);

}  // namespace sysid
