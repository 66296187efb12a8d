// What a program that ends in the middle of its work removes first.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// While one lives, these paths are removed where the program is ended by a signal before its work is (`NothingToKeep`): files, and
/// folders in which nothing is left. At most 256 in all; those beyond stay.
class RemovedAtForcedEnd {
 public:
  explicit RemovedAtForcedEnd(std::vector<std::string> paths);
  ~RemovedAtForcedEnd();
  RemovedAtForcedEnd(RemovedAtForcedEnd&&) = default;
  RemovedAtForcedEnd& operator=(RemovedAtForcedEnd&&) = delete;

 private:
  std::vector<std::string> paths_;  // whose characters stay where they are when this is moved
  std::vector<int> places_;
};

/// For a signal handler.
void remove_at_forced_end();

}  // namespace sysid
