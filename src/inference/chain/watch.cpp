// Progress and checkpoints of a run of chains.
#include "inference/chain/watch.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace sysid {

Watch::Watch(RunContext& context, std::function<nlohmann::json()> store) : context_(context), store_(std::move(store)) {}

void Watch::look(std::uint64_t done, double acceptance) {
  Clock::time_point const now = Clock::now();
  if (now - shown_ > std::chrono::milliseconds(50)) {
    context_.progress.advance(done, fmt::format("acceptance {:.2f}", acceptance));
    shown_ = now;
  }
  if (context_.checkpoint && std::chrono::duration<double>(now - saved_).count() >= context_.checkpoint_interval) {
    context_.checkpoint(store_());
    saved_ = Clock::now();
  }
}

void Watch::store_now() {
  if (context_.checkpoint) context_.checkpoint(store_());
}

}  // namespace sysid
