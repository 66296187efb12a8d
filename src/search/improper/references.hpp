// Where the search begins for parameters whose prior is improper and cannot be drawn from.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "likelihood/improper_reference.hpp"
#include "likelihood/target.hpp"
#include "result/finding.hpp"

namespace sysid::unbounded {

/// The target of a fit, with these references in its parameter space.
using MakeReferred = std::function<std::unique_ptr<Target>(std::vector<ImproperReference> const&)>;

struct References {
  std::vector<ImproperReference> of_coordinates;
  Eigen::VectorXd place;  // the best that was found
};

/// What is climbed.
struct Looked {
  bool hierarchy = false;   // some priors read parameters
  bool likelihood = false;  // it alone
};

/// A normal reference for each of these coordinates. Starts are log-uniform over 3 decades around the declared unit, of both signs
/// on a line, then over 6, 12 and 20; from the likeliest of each a few Levenberg-Marquardt rounds climb the likelihood times the
/// proper priors, without the improper ones. Around the best place found the references are as wide as its value or 30 sds on a
/// line, whichever is wider, and a decade or 10 sds on a logarithm. Empty where nothing was finite, or `stop` said so. In a
/// hierarchy it is the likelihood alone that is climbed, and the coordinates that it does not depend on follow the prior.
References find_references(MakeReferred const& make, std::vector<int> const& coordinates, Looked const& looked, std::uint64_t seed,
                           std::function<bool()> const& stop);

/// The failure of a run where no start of any bracket was.
Finding no_finite_start_of_improper();

}  // namespace sysid::unbounded
