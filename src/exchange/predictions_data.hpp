// Predictions as groups of InferenceData: the trajectories behind predict.csv, simulated once more.
#pragma once
#include <vector>

#include "app/session/session.hpp"
#include "exchange/inference_data.hpp"

namespace sysid {

/// A predict task that has results.
struct StoredPrediction {
  Task const& task;
  PredictTask const& what;
  std::uint64_t seed = 0;  // of its results
};

/// predictions and predictions_constant_data of tasks that predict from one fit. Tasks with another number of trajectories than the
/// first have groups of their own, predictions_TASK and predictions_constant_data_TASK.
void add_predictions(Session& session, std::vector<StoredPrediction> const& tasks, InferenceData& data);

/// The same of tasks that predict from one selection: those trajectories that are a candidate's, without noise. Nothing where it
/// has none.
void add_predictions(Session& session, std::vector<StoredPrediction> const& tasks, std::size_t candidate, InferenceData& data);

/// posterior_predictive of a fit with Gaussian processes over its rows: its functions along the record that it was fitted to, about
/// `draws` trajectories.
void add_process_predictive(Session& session, int fit, std::uint64_t seed, int draws, InferenceData& data);

}  // namespace sysid
