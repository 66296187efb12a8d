// Whether an equation with terms that the dictionary lacks describes a record as well as the best one of the dictionary.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "discovery/search/linearised_motion.hpp"
#include "discovery/search/whole_dictionary.hpp"
#include "result/simulation_validation.hpp"

namespace sysid {

/// The linearised motion of a dictionary: slopes in their noise's units, settings of all columns.
struct LinearisedParts {
  std::vector<SegmentSlopes> slopes;
  Eigen::VectorXd at;
  LinearisedMotion::Settings settings;
};

/// With one or more of `outside_functions`, by the linearised motion about a fit; one equation after the other is given the
/// functions. A function that drives an equation moves the states that follow by the steps from sample to sample, with its mean
/// over each interval that of its ends. Nothing where a channel measures no state. noise_sd: per channel of the model, as
/// the slopes were divided by.
std::optional<OutsideEquation> outside_form(WholeDictionary const& dictionary, FittedTerms const& lead,
                                            FitConditions const& conditions, LinearisedParts const& parts,
                                            std::vector<double> const& noise_sd, std::vector<Terms> const& near,
                                            std::function<bool()> const& interrupted);

}  // namespace sysid
