// Whether a posterior under improper priors is proper: has a finite integral.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>

#include "likelihood/target.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"

namespace sysid::unbounded {

struct Propriety {
  std::optional<Finding> failure;  // it is not: there is nothing to sample
  Findings findings;               // what could not be decided
};

/// The posterior has mass at infinity only if some coordinate with an improper prior has. From `mode` each of them is followed to
/// either side, in steps of half a decade, over 8 decades: on a line of the distance from the mode, at least to a
/// thousand times the value, on a logarithm of the parameter. At each step the others are moved to their best, and integrated over
/// by Laplace's approximation, which gives the marginal density of the logarithm of the distance,
///
///   g = log density + 1/2 sum log(1 / curvatures of the others)  [+ log distance, on a line]
///
/// whose integral is finite where it falls as a power of the distance. A side is followed until g has fallen by 30 nats, which no
/// chain climbs back: what lies further off is as if cut off. Otherwise, over the last two decades, a fall of more than half a nat
/// a decade is proper, of less than a tenth improper, and what is between is said to be undecided. That holds for the last two
/// decades before the model fails too.
///
/// Improper too is what `unbounded_density` finds at the mode, and what `find_repeats` refuses.
Propriety check_propriety(Target const& target, Mode const& mode, std::uint64_t seed, std::function<bool()> const& stop);

/// Improper: a density that changes by more than a nat when the place is moved in its last digit: there the residuals can be zero,
/// and the density grows without bound as the noise goes to zero.
std::optional<Finding> unbounded_density(Target const& target, Eigen::VectorXd const& place, std::uint64_t seed);

}  // namespace sysid::unbounded
