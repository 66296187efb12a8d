// A handler may neither allocate nor lock: the paths stand in a table of fixed size.
#include "core/system/forced_end.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <utility>

namespace sysid {
namespace {

std::array<std::atomic<char const*>, 256> table{};
static_assert(std::atomic<char const*>::is_always_lock_free, "a signal handler may touch lock-free atomics alone");

}  // namespace

RemovedAtForcedEnd::RemovedAtForcedEnd(std::vector<std::string> paths) : paths_(std::move(paths)) {
  std::size_t place = 0;
  for (std::string const& path : paths_)
    for (; place < table.size(); ++place) {
      char const* none = nullptr;
      if (!table[place].compare_exchange_strong(none, path.c_str())) continue;
      places_.push_back(static_cast<int>(place));
      break;
    }
}

RemovedAtForcedEnd::~RemovedAtForcedEnd() {
  for (int const place : places_) table[static_cast<std::size_t>(place)].store(nullptr);
}

void remove_at_forced_end() {
  // A folder can go when those in it are gone.
  for (bool removed = true; removed;) {
    removed = false;
    for (std::atomic<char const*>& each : table)
      if (char const* const path = each.load(); path != nullptr && (unlink(path) == 0 || rmdir(path) == 0)) removed = true;
  }
}

}  // namespace sysid
