// What the data say of a prior: how much they narrowed it, whether they contradict it, and whether it predicts responses of another
// size than the measured ones.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "likelihood/target.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"
#include "result/report.hpp"

namespace sysid {

/// Below, a posterior is called hardly narrower than its prior.
inline constexpr double hardly_narrower = 1.5;

/// By how much narrower the posterior's 90 % interval is than the prior's; nothing where either is not known.
std::optional<double> contraction(PriorInfo const& prior, Summary const& summary);

/// The posterior's 90 % interval; of an optimum that of its normal approximation.
std::pair<double, double> interval_90(Summary const& summary);

/// Maxima of the likelihood, the highest first, and the parameters that they state. `ml` does not use the density of the priors.
struct Maxima {
  std::span<Mode const> modes;
  std::span<ParameterInfo const> parameters;
};

/// Parameters whose posterior, or maximum of the likelihood, lies where their prior has next to nothing. A likelihood of several
/// maxima that are nearly as high contradicts no prior with which one of them agrees.
Findings check_priors(Report const& report, std::optional<Maxima> const& of_likelihood = std::nullopt);

/// Further apart than this many times: a wrong unit or a wild prior. Medians of the shipped models lie within a factor of ten of
/// what was measured, so that a unit a thousand times too large or small shows in each of them.
inline constexpr double wild = 100;
/// The share of failed draws that deserves a warning.
inline constexpr double many_failures = 0.2;

/// "120 times larger" of a ratio of 120, "120 times smaller" of its inverse.
std::string times_apart(double ratio);

/// prior_far_from_data with what was found.
Finding prior_far_from_data(std::vector<std::string> names, std::string message);

/// Where a fit explains little: adds to the help which parameters have kept the width of their prior, which may hold others where
/// they cannot fit; and where residuals are correlated in time, those whose prior hardly lets them move.
void name_held(Report const& report, Findings& findings);

}  // namespace sysid
