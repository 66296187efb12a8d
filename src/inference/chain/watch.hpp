// Reports how far a run of chains is and stores it, each no more often than is useful, whatever an iteration takes.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "inference/backend/checkpoint.hpp"
#include "search/run_context.hpp"

namespace sysid {

class Watch {
 public:
  /// store: the whole state of the run as it is then.
  Watch(RunContext& context, std::function<nlohmann::json()> store);

  /// After each batch: iterations done, and the mean acceptance rate.
  void look(std::uint64_t done, double acceptance);
  /// The run stops here.
  void store_now();

 private:
  using Clock = std::chrono::steady_clock;
  RunContext& context_;
  checkpoint::Saver saver_;
  Clock::time_point shown_ = Clock::now();
};

}  // namespace sysid
