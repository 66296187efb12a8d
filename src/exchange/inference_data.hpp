// A fit as ArviZ's InferenceData: which groups there are and what stands in them.
//
// Groups and their names after the schema of InferenceData: posterior, sample_stats, log_likelihood, posterior_predictive,
// observed_data, constant_data, prior, prior_predictive, predictions, predictions_constant_data.
#pragma once
#include "app/session.hpp"
#include "exchange/netcdf.hpp"
#include "exchange/stored_result.hpp"

namespace sysid {

struct InferenceData {
  Attributes attributes;  // of the root
  std::vector<NetcdfGroup> groups;
  std::vector<std::string> left_out;  // groups that there could be, with the reason, one line each

  void add(NetcdfGroup group) {
    if (!group.empty()) groups.push_back(std::move(group));
  }
  std::string bytes() const { return netcdf_bytes(attributes, groups); }
};

/// Who wrote the file and of which task. No hour: the same results give the same bytes.
Attributes provenance(StoredResult const& stored);

/// What the folder of a fit holds by itself: posterior and sample_stats.
InferenceData stored_inference_data(StoredResult const& stored);

/// What a fit's model and data add: observed_data, constant_data, log_likelihood, posterior_predictive, prior and prior_predictive.
/// Nothing is fitted; up to `draws` of the stored draws, as many of each chain, are simulated once more, and as many of the prior.
/// The session's results are those of `stored`. UserError, IoError where model or data do not belong to them.
void add_simulated(Session& session, int fit, StoredResult const& stored, int draws, InferenceData& data);

/// observed_data and constant_data alone.
void add_data(Session& session, FitTask const& fit, InferenceData& data);

/// predictions and predictions_constant_data: the trajectories of the predict tasks, which are those of their bands in
/// predict.csv. tasks: of one fit, each with its results.
void add_predictions(Session& session, std::vector<std::pair<Task const*, StoredResult>> const& tasks, InferenceData& data);

}  // namespace sysid
