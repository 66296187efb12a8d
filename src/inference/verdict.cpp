// Wording of the verdict: each finding with the word that `sysid explain` knows it by.
#include "inference/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid {

std::string with_care(std::ptrdiff_t warnings) {
  return fmt::format("use with care: {} to look at", warnings == 1 ? "one thing" : fmt::format("{} things", warnings));
}

Verdict judge(Findings const& findings) {
  auto const count = [&](Severity s) {
    return std::count_if(findings.begin(), findings.end(), [&](Finding const& f) { return f.severity == s; });
  };
  auto const errors = count(Severity::error), warnings = count(Severity::warning);
  Verdict verdict;
  verdict.pass = errors == 0;
  verdict.exit_code = verdict.pass ? 0 : 1;
  if (errors > 0)
    verdict.text =
        fmt::format("do not use these numbers yet: {} failed", errors == 1 ? "a check" : fmt::format("{} checks", errors));
  else if (warnings > 0)
    verdict.text = with_care(warnings);
  else
    verdict.text = "the checks pass";
  for (Severity const severity : {Severity::error, Severity::warning, Severity::note}) {
    for (Finding const& finding : findings) {
      if (finding.severity != severity) continue;
      char const* const mark = severity == Severity::error ? "failed" : severity == Severity::warning ? "warning" : "note";
      verdict.text += fmt::format("\n  {}[{}]: {}", mark, finding.code, finding.message);
      if (!finding.help.empty()) verdict.text += fmt::format("\n    what to do: {}", finding.help);
    }
  }
  if (findings.empty()) return verdict;
  bool const alike =
      std::all_of(findings.begin(), findings.end(), [&](Finding const& each) { return each.code == findings.front().code; });
  verdict.text += fmt::format("\n  more: sysid explain {}", alike ? findings.front().code : "CODE, for each word in brackets");
  return verdict;
}

}  // namespace sysid
