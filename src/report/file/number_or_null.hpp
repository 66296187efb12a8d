// Numbers that a result may lack, or that are not finite, as JSON has them.
#pragma once
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace sysid {

inline nlohmann::ordered_json number_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

}  // namespace sysid
