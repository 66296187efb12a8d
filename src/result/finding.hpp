// What a run has to say about its own result, as a value: back ends and checks find, verdict.cpp words the whole, the report shows.
// Decisions go by code, severity and names, never by the sentences.
#pragma once
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "result/finding_table.hpp"

namespace sysid {

/// error: a diagnostic fails, the numbers are not to be used; warning: usable, but look; note: for the record.
struct Finding {
  FindingCode code;
  Severity severity;               // one of those in the row of the code
  std::vector<std::string> names;  // what it concerns: parameters, channels, experiments, models, tasks, terms; may be empty
  std::string message;             // one sentence in plain words, lower case, no full stop, naming parameters and numbers
  std::string help;                // what to do; may be empty
  friend bool operator==(Finding const&, Finding const&) = default;
};

using Findings = std::vector<Finding>;

}  // namespace sysid
