// Progress and checkpoints of a run of chains.
#include "inference/chain/watch.hpp"

#include <fmt/format.h>

namespace sysid {

Watch::Watch(RunContext& context, std::function<nlohmann::json()> store) : context_(context), saver_(context, std::move(store)) {}

void Watch::look(std::uint64_t done, double acceptance) {
  Clock::time_point const now = Clock::now();
  if (now - shown_ > std::chrono::milliseconds(50)) {
    context_.progress.advance(done, fmt::format("acceptance {:.2f}", acceptance));
    shown_ = now;
  }
  saver_.save_sometimes();
}

void Watch::store_now() { saver_.save(); }

}  // namespace sysid
