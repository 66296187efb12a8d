// The lengths of a record's steps, each once: what depends on the length of a step alone is computed once for each of them.
#pragma once
#include <span>
#include <vector>

namespace sysid {

struct StepLengths {
  std::vector<double> values;  // [s], the most frequent first
  std::vector<int> of;         // per sample: which is that of the step to the next one; of the last: as of the one before
  std::vector<int> until;      // per sample: the first later one whose step is of another length, or the number of samples

  int count() const { return static_cast<int>(values.size()); }
};

/// time: [N], increasing. Where all steps are the same to 2.5e-6 of their mean, as in a part of a record that passes for equally
/// sampled, that mean alone; else those that differ by no more than the rounding of the times are one, their mean.
StepLengths step_lengths(std::span<double const> time);

}  // namespace sysid
