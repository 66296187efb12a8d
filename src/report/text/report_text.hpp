// Short texts that every writer of a report shares.
#pragma once
#include <string>
#include <string_view>

#include "core/text/diagnostic.hpp"
#include "result/evidence.hpp"

namespace sysid {

/// "log evidence 293.7 (Laplace)"; with what its axes say where that is more than half a nat, or why there is none. Empty for a fit
/// of the likelihood alone, which nobody expects to have one.
std::string evidence_text(Evidence const& evidence);

/// "error", "warning", "note".
std::string_view severity_word(Severity severity);

}  // namespace sysid
