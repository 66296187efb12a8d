// Short texts that every writer of a report shares.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "result/evidence.hpp"
#include "result/report.hpp"

namespace sysid {

/// "293.72 ± 0.02", or "293.7" where no error is known.
std::string evidence_number(double log_evidence, std::optional<double> error);
/// "log evidence 293.72 ± 0.02 (importance sampling)"; with what its axes say where that is more than half a nat, or why there is
/// none. Empty for a fit of the likelihood alone, which nobody expects to have one.
std::string evidence_text(Evidence const& evidence);

/// "log likelihood 5573.72 at its maximum (5 parameters, 500 samples)"; empty but for a fit of the likelihood alone.
std::string likelihood_text(Report const& report);
/// "no sd of ratio: it has no derivative at the optimum", of each that has none.
std::vector<std::string> without_sd_texts(Report const& report);

/// Words with each number in them as pages show it: "-324.37 ± 0.01", "5.47e-8 (5e-10)" with minus signs and powers of ten. What
/// stands in backquotes, and what is part of a name, stays.
std::string pretty_numbers(std::string_view words);
/// A value with its unit in one piece: a line does not end within it.
std::string quantity_text(double value, int digits, std::string_view unit);

/// "error", "warning", "note".
std::string_view severity_word(Severity severity);

}  // namespace sysid
