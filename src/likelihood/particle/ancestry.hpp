// Where particles come from: what their ancestors were at earlier samples, as long as enough of these are different.
#pragma once
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// Values of particles at a sample are given the later samples through the weights of their descendants. After each resampling
/// fewer ancestors have descendants: before they would be too few, or after `longest` samples, values are emitted as they stand,
/// given the samples so far.                                                                        Kitagawa 1996, sec. 3.2
class Ancestry {
 public:
  /// values [rows x N] at `sample` of what particles of these weights [N] descend from: origin[w] is the column of particle w.
  using Emit =
      std::function<void(int kind, int sample, ConstLanes values, std::span<int const> origin, std::span<double const> weights)>;
  Ancestry(int particles, Emit emit);

  /// Values of the particles as they are now. kind: of the values, handed on.
  void add(int kind, int sample, LaneArray values);
  /// To be called before particle w becomes what ancestors[w] was. weights: before.
  void resample(std::span<int const> ancestors, std::span<double const> weights);
  /// Emits what is older than `longest` samples before `sample`.
  void forget(int sample, std::span<double const> weights);
  void end(std::span<double const> weights);

  static constexpr int longest = 200;
  static int fewest(int particles);

 private:
  struct Entry {
    int kind, sample;
    LaneArray values;
    std::vector<int> origin;
  };
  void emit(Entry const& entry, std::span<double const> weights) const;
  int different(std::span<int const> origin);

  int particles_;
  Emit emit_;
  std::deque<Entry> entries_;
  std::vector<int> seen_, next_;
  int mark_ = 0;
};

}  // namespace sysid
