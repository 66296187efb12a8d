// Whether an equation with terms that the dictionary lacks describes a record as well as the best one of the dictionary.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "discovery/search/linearised_motion.hpp"
#include "discovery/search/whole_dictionary.hpp"

namespace sysid {

/// The most probable set of terms with one or more of `outside_functions`, against the most probable one without.
struct OutsideForm {
  std::string equation, terms;  // "v'", "v, exp(-r), exp(-2*r)"
  double log_odds = 0;          // against the best one without, in the dictionary with these functions
};

/// The linearised motion of a dictionary with more columns: slopes in their noise's units, settings of all columns.
struct LinearisedParts {
  std::vector<SegmentSlopes> slopes;
  Eigen::VectorXd at;
  LinearisedMotion::Settings settings;
};

/// By the linearised motion about a fit; one equation after the other is given the functions. A function that drives an equation
/// moves the states that follow by the steps from sample to sample, with its mean over each interval that of its ends. Nothing
/// where a state or a sample is not measured. noise_sd: per channel of the model, as the slopes were divided by.
std::optional<OutsideForm> outside_form(WholeDictionary const& dictionary, FittedTerms const& lead, FitConditions const& conditions,
                                        LinearisedParts const& parts, std::vector<double> const& noise_sd,
                                        std::vector<Terms> const& near, std::function<bool()> const& interrupted);

}  // namespace sysid
