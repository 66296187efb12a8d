// Findings of a page.
#include "result/check_page.hpp"

namespace sysid {

Findings TaskPage::all_findings() const {
  Findings all = findings;
  for (PreflightPage const& preflight : preflights) all.insert(all.end(), preflight.findings.begin(), preflight.findings.end());
  return all;
}

}  // namespace sysid
