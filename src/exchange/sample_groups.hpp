// What belongs to the rows of an experiment: measured samples, inputs, predicted samples, pointwise log likelihoods.
#pragma once
#include <span>

#include "app/session/session.hpp"
#include "exchange/netcdf.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// `displacement`, or `displacement[hall]` where `label` says which of several records it is of.
std::string labelled(std::string const& name, std::string const& label);

/// Rows of an experiment, as indices into it, and how their dimension is called.
struct RowsOfExperiment {
  std::string dimension;  // "row"
  std::string time;       // "time", which goes along with it; empty where rows have no time
  std::vector<int> rows;
};

/// The rows that are scored.
RowsOfExperiment scored_rows(Experiment const& experiment, Dynamics dynamics, std::string const& label);

/// Their dimension, by the numbers that the file's rows have, and their times.
void add_rows(NetcdfGroup& group, Experiment const& experiment, RowsOfExperiment const& rows);

/// The attributes of a variable over rows: its unit, and that time goes along.
Attributes row_attributes(std::string const& unit, RowsOfExperiment const& rows);

/// Inputs of the model, declared units.
void add_inputs(NetcdfGroup& group, Model const& model, Experiment const& experiment, RowsOfExperiment const& rows,
                std::string const& label);

/// Constants that the data block of an experiment gives to parameters of the model, declared units.
void add_constants(NetcdfGroup& group, Model const& model, ExperimentUse const& use, std::string const& label);

/// Samples of the channels that the experiment measures, declared units, NaN where one is missing. suffix: after the channel's
/// name.
void add_measured(NetcdfGroup& group, Model const& model, Experiment const& experiment, RowsOfExperiment const& rows,
                  std::string const& suffix, std::string const& label);

/// Of each channel its samples to come, noise included, under its name where the noise is known, and without as NAME_response;
/// states and quantities derived at each sample under their names. Declared units; NaN throughout where a solve failed. Dimensions
/// chain and draw are there, with as many places as `result` has trajectories, in their order.
void add_trajectories(NetcdfGroup& group, Model const& model, std::span<TrajectoryQuantity const> quantities,
                      Trajectory::Result const& result, RowsOfExperiment const& rows, std::string const& label);

}  // namespace sysid
