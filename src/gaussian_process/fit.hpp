// Hyper-parameters by maximising their posterior density from several starts, with concerns about the result.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "gaussian_process/concern.hpp"
#include "gaussian_process/covariance.hpp"
#include "gaussian_process/observations.hpp"

namespace sysid::gaussian_process {

/// The marginal likelihood at hyper-parameters and noise, by either route.
using Likelihood = std::function<Marginal(Numbers parameters, bool with_gradient)>;

/// log density of the logarithms of all parameters, constants kept, its derivatives added to `gradient`; empty: flat in the
/// logarithms.
using LogPrior = std::function<double(Eigen::VectorXd const& logarithms, Eigen::VectorXd& gradient)>;

/// Where to look for one parameter; all three > 0. lower == upper == start: it is known (and may be 0: no noise).
struct Range {
  std::string name;
  double lower = 0, upper = 0, start = 0;
};

/// What the observations suggest: a hyper-parameter of unit output^a input^b is about (their sd)^a (the input's width)^b; bounds
/// are 1000 times below and above, for the noise's sd (the last range) from 1e-6 to 10 times that of the observations. Nothing when
/// a unit of the kernel's own (a force) takes part: nobody but the user knows its scale.
std::optional<std::vector<Range>> suggested_ranges(Covariance const& covariance, Observations const& observations);

struct FitSettings {
  int starts = 5;              // the first from the ranges' `start`, the others drawn around it
  double spread = 10;          // log-uniformly between start/spread and start*spread, inside the bounds
  StreamKey key = {};          // start s uses stream key.with_index(s) alone
  double tolerance = 1e-6;     // of the log density
  int most_evaluations = 200;  // of each start
};

struct Optimum {
  std::vector<double> parameters;
  double log_density = 0;  // likelihood times prior, of the logarithms
  double log_likelihood = 0;
  double jitter = 0;
  int evaluations = 0;
  bool converged = false;
};

struct Fit {
  std::vector<Optimum> optima;  // one per start that found a finite density, the best first; empty with a fatal concern
  Concerns concerns;
};

/// observations: how many, the size of the log likelihood.
Fit fit(Likelihood const& likelihood, LogPrior const& prior, std::vector<Range> const& ranges, Eigen::Index observations,
        FitSettings const& settings);

}  // namespace sysid::gaussian_process
