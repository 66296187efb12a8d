// Modes that lie at a bound of a prior, where what a Laplace approximation says of the parameter means nothing: coordinates end
// there at infinity.
#pragma once
#include <vector>

#include "result/mode.hpp"
#include "result/parameter_info.hpp"
#include "search/objective.hpp"

namespace sysid {

/// Whether a declared value lies at a bound of its prior's support, as far as it and its sd tell it: nearer to the bound than its
/// sd, and within a thousandth of the support's width or of a positive lower bound; where the support has one bound only and so no
/// width, within a tenth of the sd. An sd that is not known, 0, contradicts nothing.
bool at_bound(ParameterInfo const& parameter, double declared, double sd);

struct ModeAtBound {
  int parameter = 0;
  bool upper = false;      // which bound
  bool unbounded = false;  // the density still rises towards it: it has no maximum
};

/// The parameters that lie at a bound in a mode of `objective`, as its density tells it, ascending. At a bound it does not fall
/// when the parameter is moved to a thousandth of its distance: a mode x sds away from the bound, x^2/2 of which are seen, is
/// inside. Where a support has two bounds, the mode must also be within a thousandth of its width or of a positive lower bound.
/// The density must fall by half a nat between the mode and the other end of the prior: else the data do not determine the
/// parameter, which is another finding.
std::vector<ModeAtBound> modes_at_bounds(Objective const& objective, Mode const& mode);

}  // namespace sysid
