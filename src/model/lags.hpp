// Discrete time: which past samples a model uses, and what replaces them in a prediction.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "model/model.hpp"

namespace sysid {

/// Where lagged samples come from.
enum class PredictionRule {
  as_written,  // `lag(y, 1)` from the simulated state, `lag(measured(c), 1)` from the data
  one_step,    // from the data, wherever a channel measures what is lagged
  free_run,    // from the model: measured samples only before the first row
};
std::string_view prediction_name(PredictionRule rule);

/// Gives every lagged quantity that is read, leaf previous(quantity, lag), its registers: states named "lag(y, 1)", "lag(y, 2)",
/// ..., whose derivative is their value at the next sample. Registers of a quantity p begin with initial[p]: an expression of
/// parameters, and of measured samples as if it stood at the register's own sample; what a channel predicts begins with what it
/// measured. Returns the first lagged quantity that is read and has no initial value.
std::optional<int> lay_out_lags(Model& model, std::vector<std::optional<NodeId>> const& initial);

/// The model under a rule. Nothing when it asks for one-step prediction and no channel measures what is lagged.
std::optional<Model> with_prediction(Model model, PredictionRule rule);

/// Every process at zero, the mean of its prior: what is left is the parametric part.
void remove_processes(Model& model);

/// Whether a state reads a process: what it is at one sample then shows in later ones.
bool feeds_back(Model const& model);

/// Whether a time between samples is the one that a model declares: to 1 %, since printed times are rounded.
bool same_step(double step, double declared);

/// How many rows before the first one a model reads.
int data_lag(Model const& model);

/// A measured sample that is read `lag` samples later.
struct PastSample {
  int channel = 0;
  int lag = 0;
};
/// Read by the density of `channel`; by the map from sample to sample (channel = -1), where a missing one would spoil all that
/// follows; before the first row alone (channel = -2).
std::vector<PastSample> lagged_samples(Model const& model, int channel);

}  // namespace sysid
