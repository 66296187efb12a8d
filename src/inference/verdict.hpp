// All findings of a run in one answer: can these numbers be used, why not, what to do; and the exit code's class.
#pragma once
#include <cstddef>
#include <string>

#include "inference/finding.hpp"

namespace sysid {

struct Verdict {
  bool pass = true;
  int exit_code = 0;  // 0 diagnostics pass, 1 a diagnostic fails
  std::string text;   // one or more lines in plain words, no trailing newline
};

/// "use with care: 2 things to look at".
std::string with_care(std::ptrdiff_t warnings);

/// Fails when any finding is an error; warnings and notes are listed after the errors, in the order found.
Verdict judge(Findings const& findings);

}  // namespace sysid
