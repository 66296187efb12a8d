// Whether a smoothed disturbance stands in for a term that the equations lack.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "result/finding.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// A column of a regression and what it says of another one.
struct FollowedTerm {
  double coefficient = 0;
  double share = 0;            // of the mean square that it explains beyond the columns before it
  double standard_errors = 0;  // of the coefficient, from 0
  double independent = 0;      // values of the term that the samples of it are worth
};

/// values: what may follow `term`, beside the columns of `base`; all of one length.
///
///   values = base b + a term + r,   standard error of a: of the parts f of `term` that are orthogonal to `base`,
///   se^2 = (c_0 g_0 + 2 sum c_k g_k)/(f f)^2,   c_k = sum r_i r_i+k / n,   g_k = sum f_i f_i+k,
///
/// up to the first pair of lags whose sum is not positive (Geyer 1992, section 3.3): a smoothed disturbance is correlated in time
/// even where the disturbance is white, and so is a term. Of a term alone n g_0/(g_0 + 2 sum g_k) values are independent. Nothing
/// where `term` is a combination of `base`.
std::optional<FollowedTerm> followed_term(std::span<double const> values, std::span<std::vector<double> const> base,
                                          std::span<double const> term);

/// Why the disturbances of a model are not compared with its states; empty: they are.
std::string without_disturbance_terms(Model const& model, std::span<Prediction const> states);

/// A finding for each disturbance that a low power of the smoothed states explains far beyond chance: by a fifth of its mean
/// square and 6 standard errors, from 20 independent values of it or more. Of linear terms only for white disturbances that the
/// record shows: whose smoothed values are larger than the uncertainty of them. taken: whether a name stands in the user's text.
/// states: of each experiment, declared units.
Findings check_disturbance_terms(Model const& model, std::span<Prediction const> states,
                                 std::function<bool(std::string const& name)> const& taken = {});

}  // namespace sysid
