// `auto`: the sampler that suits what the search has found.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "inference/backend/backend.hpp"

namespace sysid::automatic {

struct Choice {
  std::string_view backend;
  std::string reason;  // "two modes ...": what was found, and what follows; no full stop
};

/// By the first of these that applies:
///
///   mh         a likelihood that is estimated by particles
///   mh         several modes of notable mass: of more than 20 parameters, where a density is expensive, and where draws from the
///              normal distributions at the modes are worth 10 % of independent ones or more
///   tempering  several modes of notable mass otherwise
///   mh         a mode that is flat in some direction; derivatives by differences
///   nuts       more than 25 parameters, and draws from the normal distribution at the mode worth less than 1 % of independent ones
///   mh         otherwise
///
/// modes: of the posterior, by falling share, at least one. Simulates 512 draws where their worth decides.
Choice choose(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger);

/// The chosen back end with its defaults.
FitResult run(Target const& target, Settings const& settings, RunContext& context);

}  // namespace sysid::automatic
