// A sensor that froze, and one whose range ended: equal numbers in a row where those around them differ.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// Samples that repeat the one before them, first to last; missing ones between them count as such.
struct FrozenRun {
  std::size_t first = 0, last = 0;
  std::size_t samples = 0;  // that are there
  double value = 0;
};

/// A tenth of the samples or more (20 at least) that are one number, in a record that is rough elsewhere, as noise makes it, and
/// where no more than one sample in twenty repeats the one before it: so a slow signal in coarse steps, a switch or a count has
/// none. Ten samples suffice where no more than one in 200 repeats the one before it, so that chance has no such run; where all
/// other runs are a fifth as long at most; and where the number is neither the largest nor the smallest. Nothing where the run
/// begins the record, which may be at rest, or where the motion dies out before it. values: NaN missing.
std::optional<FrozenRun> frozen_run(std::span<double const> values);

/// The largest or the smallest number, with the samples that stand there three and more in a row.
struct ClippedSamples {
  double value = 0;
  bool largest = false;
  std::vector<std::size_t> places;
};

/// The ends of the range, the upper one first, at which one sample in fifty or more (10 at least) stands in such runs, of a record
/// that elsewhere is rough as the one above; 5 samples suffice where no more than one in 200 elsewhere repeats the one before it. A
/// smooth one must be cut off three times or more, each time while it moves as fast as usual and in steps much larger than those of
/// its numbers: a rounded peak is not. Runs that begin the record do not count, nor does 0, which is where many quantities end, nor
/// what is straight between its stops.
std::vector<ClippedSamples> clipped_samples(std::span<double const> values);

}  // namespace sysid
