// How often a record uses an unknown function, counted in equal parts of a range.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace sysid {

/// Of one input of a function, nothing counted yet.
inline std::vector<double> no_visits() { return std::vector<double>(60, 0.0); }

/// Counts a reading; place: 0 at the beginning of the range, 1 at its end. Outside of it nothing is counted.
inline void count_visit(std::vector<double>& visits, double place) {
  if (place >= 0 && place <= 1)
    visits[std::min(visits.size() - 1, static_cast<std::size_t>(place * static_cast<double>(visits.size())))] += 1;
}

}  // namespace sysid
