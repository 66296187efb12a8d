// The median of the steps decides what is a gap.
#include "data/cell/usual_step.hpp"

#include <algorithm>
#include <vector>

namespace sysid {

UsualStep usual_step(std::span<double const> time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  UsualStep usual{0, sorted[sorted.size() / 2], 0};
  usual.gaps = static_cast<int>(std::count_if(steps.begin(), steps.end(), [&](double each) { return usual.is_gap(each); }));
  usual.step = usual.gaps > 0 ? usual.median : (time.back() - time.front()) / static_cast<double>(steps.size());
  return usual;
}

}  // namespace sysid
