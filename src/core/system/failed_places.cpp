// The traced part of a ledger.
#include "core/system/failed_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sysid {

std::string failed_places(Ledger const& ledger) {
  std::vector<Failure> failures = ledger.failures();
  std::erase_if(failures,
                [](Failure const& each) { return each.where == Ledger::untraced || each.where.ends_with(Ledger::not_traced); });
  std::stable_sort(failures.begin(), failures.end(), [](Failure const& a, Failure const& b) { return a.count > b.count; });
  std::string places;
  for (std::size_t i = 0; i < failures.size() && i < 3; ++i)
    places += fmt::format("{}{} in {}{}", i == 0 ? "" : ", ", name(failures[i].kind), failures[i].where,
                          std::isnan(failures[i].time) ? "" : fmt::format(" at t = {:.4g} s", failures[i].time));
  return places;
}

}  // namespace sysid
