// Findings of a page.
#include "result/check_page.hpp"

namespace sysid {

Findings TaskPage::all_findings() const {
  Findings all = findings;
  for (Outlook const& outlook : outlooks) all.insert(all.end(), outlook.findings.begin(), outlook.findings.end());
  return all;
}

}  // namespace sysid
