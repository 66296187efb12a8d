// The memory that a simulation needs, and its iterations if the model reads its own output.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/process/drawn_functions.hpp"
#include "app/session/session.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// Of inputs and their polynomials, what is recorded, simulated twice, and the text of the record.
double bytes_to_simulate(SimulateTask const& what, CompiledModel const& compiled);

/// Takes from a run what the next one reads; false where that is what this one read.
using Feedback = std::function<bool(Trajectory::Result const& run, Experiment& experiment)>;

/// A model that goes on from what it measured: noise enters all that follows.
Feedback measured_samples(CompiledModel const& compiled);
/// Processes are the last inputs; before the record they are zero, as all inputs are. time: `history` samples before it included.
Feedback drawn_values(DrawnFunctions const& functions, std::vector<double> const& time, int history);

/// The run that reads what it makes; nothing: interrupted. UserError (E5001) where there is none.
std::optional<Trajectory::Result> in_rounds(Session& session, Task const& task,
                                            std::shared_ptr<CompiledModel const> const& compiled, Experiment& experiment,
                                            SimulateTask const& what, LaneArray const& parameters, StreamKey noise_key,
                                            std::vector<Feedback>& feedbacks);

}  // namespace sysid
