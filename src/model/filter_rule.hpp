// How the likelihood of a model with random states is computed.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// What a task may state as `filter = ...`.
enum class FilterRule {
  automatic,  // kalman where the model is linear in its states, else extended
  kalman,     // exact: linear in states and disturbances, normal noise
  extended,   // the model linearised at the mean of the states
  unscented,  // moments over sigma points
  particle,   // by weighted particles: an unbiased estimate, for any noise
};

/// "auto", "kalman", ...: the word that the user writes.
std::string_view filter_name(FilterRule rule);
std::optional<FilterRule> find_filter(std::string_view name);
std::vector<std::string> filter_names();

}  // namespace sysid
