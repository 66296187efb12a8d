// The table of settings, and values that do not go together.
#include "inference/jump/plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "inference/chain/chain_run.hpp"

namespace sysid::jump {
namespace {

constexpr SettingRow rows[] = {
    {"samples", SettingKind::integer, "5000", 1, 1e9, "", "iterations of each chain, burn-in included"},
    {"burn_in", SettingKind::integer, "1000", 0, 1e9, "",
     "first iterations, discarded; weights adapt during them so that all models are visited equally often"},
    {"thin", SettingKind::integer, "4", 1, 1e9, "", "keep every thin-th iteration after burn-in"},
    {"chains", SettingKind::integer, "8", 1, 65536, "", "number of independent chains"},
    {"pilot", SettingKind::integer, "2000", 100, 1e8, "",
     "iterations, a quarter of them burn-in, of each of the four chains that sample a model's posterior before the jumps; up to 16 "
     "times as many are used if these are not enough"},
};

/// Parts of all chains together: their scatter is then known to a tenth.
constexpr std::uint64_t wanted_parts = 48, least_part = 5 * Plan::cycle;

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) { return refuse_kept(settings); }

std::uint64_t Plan::parts() const {
  std::uint64_t const wanted = std::max<std::uint64_t>(4, wanted_parts / static_cast<std::uint64_t>(chains));
  return std::clamp<std::uint64_t>((samples - burn_in) / least_part, 1, wanted);
}

std::uint64_t Plan::part_of(std::uint64_t iteration) const {
  return std::min(parts() - 1, (iteration - burn_in) * parts() / (samples - burn_in));
}

Plan plan_of(Settings const& settings) {
  return {static_cast<std::uint64_t>(settings.integer("samples")), static_cast<std::uint64_t>(settings.integer("burn_in")),
          static_cast<std::uint64_t>(settings.integer("thin")), static_cast<int>(settings.integer("chains")),
          settings.integer("pilot")};
}

}  // namespace sysid::jump
