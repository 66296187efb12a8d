// How the evidence of a fit is computed: what `evidence = ...` may say, and what a result says that was done.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class EvidenceMethod { automatic, importance, bridge, smc, laplace, none };

/// As the language has it: "auto", "importance", "bridge", "smc", "laplace", "none".
std::string_view word(EvidenceMethod method);
std::optional<EvidenceMethod> evidence_method(std::string_view word);
/// All of them.
std::vector<std::string> evidence_words();
/// For people: "importance sampling", "bridge sampling", "tempered SMC", "Laplace".
std::string_view title(EvidenceMethod method);

}  // namespace sysid
