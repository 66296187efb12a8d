// The evidence of a model by Laplace's approximation, from the modes that a fit has found.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "likelihood/target.hpp"
#include "result/evidence.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// From the modes of the density that `objective_kind` names, which are followed to those of the density on the sampler's
/// coordinates:
///
///   log p(y) = log sum over modes m of p(y | u_m) p(u_m) (2 pi)^(P/2) det(H_m)^(-1/2)         MacKay 2003, ch. 27 and 28
///
/// u [P] the sampler's coordinates, p(u) with the Jacobian and all constants, H minus the second derivatives of log p(y, u). Exact
/// where the density is normal in u. Nothing, with a reason, for `likelihood` (which has no prior), where the highest mode is at a
/// bound or flat in some direction, and where nothing is left of the modes.
///
/// along_axes: the density along each axis of the ellipsoid, through its mode, by Gauss-Hermite quadrature of five points against
/// the normal one, logs summed over the axes.
/// weighted: whether weighted draws check the number (`sampled`).
Evidence laplace_evidence(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                          Ledger& ledger, std::function<bool()> const& stop = {}, bool weighted = true);

}  // namespace sysid
