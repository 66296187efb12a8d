// Identifiability from derivatives at prior draws, in words: null directions, expected sds, confounded pairs.
#pragma once
#include <vector>

#include "diagnostics/identifiability/identifiability.hpp"
#include "likelihood/output.hpp"
#include "result/check_page.hpp"

namespace sysid {

/// A sampled parameter of a fit, as it is assessed here.
struct AssessedParameter {
  ParameterWords words;
  ParameterRole role = ParameterRole::response;
  bool relative = false;      // by its logarithm
  double spread = 0;          // the prior's sd: of the logarithm, or SI
  bool coefficient = false;   // of an unknown function; these stand last
  bool standardised = false;  // an experiment's member of a population, normal(0, sd = 1): its prior tells it from mean and spread
};

/// Fills lines, rank and null directions of `page.information` and adds findings. locals: at two draws or more, with respect to the
/// coordinates whose role is `response`, in their order. channels: "displacement", for sentences; driven: the model has an input.
void describe_information(std::vector<AssessedParameter> const& coordinates, std::vector<LocalSlopes> const& locals,
                          std::string const& channels, bool driven, PreflightPage& page);

}  // namespace sysid
