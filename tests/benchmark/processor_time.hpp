// Processor time of this thread: what others do on the machine counts little.
#pragma once
#include <ctime>

#include <algorithm>
#include <vector>

namespace processor_time {

inline double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double of(Work const& work) {
  double const begin = seconds();
  work();
  return seconds() - begin;
}

inline double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace processor_time
