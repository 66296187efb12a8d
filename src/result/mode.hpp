// An optimum with its widths, as searches find it.
#pragma once
#include <vector>

namespace sysid {

/// An optimum and its Gaussian (Laplace) approximation.
struct Mode {
  std::vector<double> theta;       // [P], sampler's coordinates
  std::vector<double> declared;    // [P], declared units
  std::vector<double> sd;          // [P], declared units, to first order in the width
  std::vector<double> covariance;  // [P x P] by rows, sampler's coordinates
  double log_density = 0;          // of the objective at theta, all constants kept
  double log_mass = 0;       // log integral of its Laplace approximation: over the sampler's coordinates where the objective is
                             // the density there, else over the declared parameters
  double share = 0;          // of the sum of all modes' masses; of `ml`, of their likelihoods
  int hits = 0;              // local searches that ended here
  std::vector<double> flat;  // [K x P] moves of the declared parameters, a tenth of a prior width at most, that nothing
                             // resists: widths along them are the prior's; empty: well defined
  double gain = 0;  // of log density that a further step of the search promises, as far as bounds leave room; infinite: not known
  bool stalled = false;  // where gain is large: no step found it; else rounds came to their end
};

}  // namespace sysid
