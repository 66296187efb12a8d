// What every page keeps to, whatever task it is of: well-formed, nothing from outside, an order of headings, names for all that is
// seen.
#pragma once
#include <string>

namespace sysid::test {

/// A line for each rule that the page breaks; "" for a good page.
std::string broken_rules(std::string const& page);

}  // namespace sysid::test
