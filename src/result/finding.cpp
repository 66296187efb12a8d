// The table's severities hold for every finding that is made.
#include "result/finding.hpp"

#include <utility>

namespace sysid {

Finding::Finding(FindingCode code, Severity severity, std::vector<std::string> names, std::string message, std::string help)
    : code(code), severity(severity), names(std::move(names)), message(std::move(message)), help(std::move(help)) {
  if (!row_of(code).severities.contains(severity))
    throw InternalError("a finding of a severity that its row does not have: " + std::string(word(code)));
}

}  // namespace sysid
