// What a program's equations read of the record, as columns of its data.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "simulate/schedule.hpp"

namespace sysid {

class StanColumns {
 public:
  /// `d[2]`: the column of a leaf in a row that is called `row`; it gets one where it has none.
  std::string text(Node const& leaf, std::string_view row);
  /// In the order of their columns. The first is time, so that there is one.
  std::vector<UniformLeaf> const& leaves() const { return leaves_; }
  int count() const { return static_cast<int>(leaves_.size()); }

 private:
  std::vector<UniformLeaf> leaves_ = {{LeafKind::time, 0, Stage::begin, 0}};
};

}  // namespace sysid
