// Metropolis-Hastings as a back end: starts from a global search, burn-in with adaptation, frozen sampling, checkpoints,
// diagnostics.
#pragma once
#include "inference/backend/backend.hpp"

namespace sysid::mh {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

/// `samples` iterations of `chains` chains; the first `burn_in` are dropped, every `thin`-th of the rest is kept. Chains start
/// around the modes of the posterior, spread by their masses and wider than the posterior (`start = global`), or at draws from the
/// prior. `adaptive`: full covariance and scale learnt in burn-in from the chains that share a mode, then frozen, so what is kept
/// comes from a time-homogeneous chain. `spherical`: the tutorial's (8.17), covariance `variance` times I in the sampler's
/// coordinates (log or logit for bounded parameters); it almost never moves on a well-measured system, and the findings say so.
FitResult run(Target const& target, Settings const& settings, RunContext& context);

}  // namespace sysid::mh
