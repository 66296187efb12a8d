// Mutations as disks, networks and editors make them: bits and bytes, cuts, repeated and moved parts, other numbers.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/numeric/random.hpp"

namespace sysid::fuzz {

class Mutator {
 public:
  explicit Mutator(StreamKey key) : stream_(key) {}

  /// One to three changes of bytes.
  std::string operator()(std::string bytes);
  /// A value of the same kind of file with one part exchanged, removed, repeated or of another type.
  nlohmann::json operator()(nlohmann::json value);
  /// Below `count`; 0 where that is 0.
  std::uint64_t below(std::uint64_t count) { return count == 0 ? 0 : stream_.below(count); }

 private:
  void change(std::string& bytes);

  Stream stream_;
};

}  // namespace sysid::fuzz
