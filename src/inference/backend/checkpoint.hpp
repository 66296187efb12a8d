// The state of a run as a JSON value: which run it belongs to, and why one cannot be resumed.
#pragma once
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/setting/settings.hpp"
#include "inference/backend/backend.hpp"
#include "search/stored_values.hpp"

namespace sysid::checkpoint {

/// Who made a checkpoint: back end, its settings, seed, and the target's parameters.
nlohmann::json identity(std::string_view backend, Settings const& settings, std::uint64_t seed, Target const& target);
/// The same of candidates; models: whatever tells them from others.
nlohmann::json identity(std::string_view backend, Settings const& settings, std::uint64_t seed, nlohmann::json models);

/// The finding that ends a run whose checkpoint does not fit; empty when `stored` carries `expected` as its "identity".
std::optional<Finding> refuse(nlohmann::json const& stored, nlohmann::json const& expected);
Finding unusable(std::string const& why);
/// Calls `what`, which reads a checkpoint: the finding that it does not fit or is damaged, or nothing.
std::optional<Finding> read(std::function<void()> const& what);

/// Gives the context the state of a run, no more often than it asks for; never where it takes none.
class Saver {
 public:
  /// store: the whole state as it is then.
  Saver(RunContext& context, std::function<nlohmann::json()> store);

  void save_sometimes();
  void save();

 private:
  using Clock = std::chrono::steady_clock;
  RunContext& context_;
  std::function<nlohmann::json()> store_;
  Clock::time_point saved_ = Clock::now();
};

}  // namespace sysid::checkpoint
