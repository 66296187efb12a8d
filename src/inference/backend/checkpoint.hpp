// The state of a run as a JSON value: whose it is, and why one cannot be gone on from.
#pragma once
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

/// The finding that ends a run whose checkpoint does not fit; empty when `stored` carries `expected` as its "identity".
std::optional<Finding> refuse(nlohmann::json const& stored, nlohmann::json const& expected);
Finding unusable(std::string const& why);
/// Calls `what`, which reads a checkpoint: the finding that it does not fit or is damaged, or nothing.
std::optional<Finding> read(std::function<void()> const& what);

}  // namespace sysid::checkpoint
