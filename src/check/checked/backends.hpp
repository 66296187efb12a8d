// The back ends that tasks may name, as the checker sees them.
#pragma once
#include <span>
#include <string_view>

#include "core/setting/settings.hpp"

namespace sysid {

/// A back end as tasks may name it: the checker knows its settings, and what it makes of a prior.
struct BackendSettings {
  std::string_view name;
  std::span<SettingRow const> settings;
  bool optimum = false;    // its result is the largest density, no draws
  bool prior = true;       // that density contains the prior
  bool estimates = false;  // it samples the posterior of a likelihood that is known by unbiased estimates
  bool distances = false;  // it compares distances of simulations, without a likelihood
};

/// Those that a file's tasks may name.
struct Backends {
  std::span<BackendSettings const> fitting;
  std::span<BackendSettings const> selecting;
  std::span<BackendSettings const> discovering;  // selectors of terms, the first is the default
  std::span<BackendSettings const> derivatives;  // forms of derivatives for discovery, likewise
  BackendSettings samples;                       // in their place in discrete time
};

}  // namespace sysid
