// The no-U-turn sampler as a back end: for posteriors that can be followed by their gradient, of many parameters above all.
#pragma once
#include "inference/backend/backend.hpp"

namespace sysid::nuts {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

/// `chains` independent chains, each leapfrog step of all of them one batch: no chain waits for a longer trajectory of another, and
/// no chain learns from another. Metric and step are learnt in burn-in and then frozen. What is kept is every `thin`-th state after
/// burn-in.
FitResult run(Target const& target, Settings const& settings, RunContext& context);

}  // namespace sysid::nuts
