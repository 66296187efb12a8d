// What a run has to say about its own result, as a value: back ends and checks find, verdict.cpp words the whole, the report shows.
#pragma once
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"

namespace sysid {

/// error: a diagnostic fails, the numbers are not to be used; warning: usable, but look; note: for the record.
struct Finding {
  Severity severity = Severity::note;
  std::string code;     // one word for programs: "chain_did_not_move"
  std::string message;  // one sentence in plain words, lower case, no full stop, naming parameters and numbers
  std::string help;     // what to do; may be empty
  friend bool operator==(Finding const&, Finding const&) = default;
};

using Findings = std::vector<Finding>;

}  // namespace sysid
