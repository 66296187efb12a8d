// A fit as ArviZ's InferenceData: its groups, and those that need no simulation.
//
// Groups and their names after the schema of InferenceData: posterior, sample_stats, log_likelihood, posterior_predictive,
// observed_data, constant_data, prior, prior_predictive, predictions, predictions_constant_data.
#pragma once
#include "app/session/session.hpp"
#include "exchange/netcdf.hpp"
#include "exchange/stored_result.hpp"

namespace sysid {

struct InferenceData {
  Attributes attributes;  // of the root
  std::vector<NetcdfGroup> groups;
  std::vector<std::string> omitted;  // groups that there could be, with the reason, one line each

  void add(NetcdfGroup group) {
    if (!group.empty()) groups.push_back(std::move(group));
  }
  std::string bytes() const { return netcdf_bytes(attributes, groups); }
};

/// Who wrote the file and of which task. No hour: the same results give the same bytes.
Attributes provenance(StoredResult const& stored);

/// What the folder of a fit holds by itself: posterior and sample_stats.
InferenceData stored_inference_data(StoredResult const& stored);

/// observed_data and constant_data of a fit.
void add_data(Session& session, FitTask const& fit, InferenceData& data);

}  // namespace sysid
