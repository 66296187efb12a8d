// Where a rank runs: which processors it may use, and whether it is still there.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid::ranks {

/// As bytes that other ranks may read.
std::string place_of_this_process();

/// Of all ranks, in order.
class Places {
 public:
  Places() = default;
  explicit Places(std::span<std::string const> all);
  /// For each rank so many that no processor has two; at least one. Processors that several ranks of a node may use are divided.
  int threads() const;
  /// Whether a node has more ranks than processors for them.
  bool crowded() const;
  /// A rank that has ended, of those whose processes can be seen from here; -1: none.
  int ended(int own) const;
  /// "process 1234 on node07"
  std::string words(int rank) const;

 private:
  double processors() const;

  std::vector<std::string> all_;
};

}  // namespace sysid::ranks
