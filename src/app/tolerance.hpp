// The tolerance guard: is the integration error small against the width of the posterior?
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "inference/backend.hpp"
#include "likelihood/model_target.hpp"

namespace sysid {

/// A parameter may move by this many of its sds when the step is halved.
constexpr double tolerable_move = 0.1;

using MakeTarget = std::function<std::unique_ptr<ModelTarget>(int substeps)>;

/// The smallest substeps = 1, 2, 4, ... for which no mode moves by more than `tolerable_move` sds at twice as many; the modes
/// there.
struct SettledSubsteps {
  int substeps = 1;
  std::vector<Mode> modes;
  std::vector<std::pair<int, double>> moves;  // substeps tried, largest move on doubling [sd]
  bool settled = true;                        // false: still moving at the most that is tried (256)
};
SettledSubsteps settle_substeps(MakeTarget const& make, std::vector<Mode> modes, std::uint64_t seed, Ledger& ledger);

/// After sampling: by how many sds each posterior mean moves when the step is halved, from the change of log likelihood over up to
/// 200 draws (to first order the move of a mean is the covariance of the parameter with that change). Names the worst.
struct ToleranceCheck {
  std::string parameter;
  double move = 0;  // [sd]
};
ToleranceCheck check_tolerance(ModelTarget const& coarse, ModelTarget const& fine, Draws const& draws, Ledger& ledger);

/// Fires above `tolerable_move`.
Findings tolerance_findings(ToleranceCheck const& check, int substeps);

}  // namespace sysid
