// How well a model with given coefficients predicts rows: one row ahead, k rows ahead, and in a free run.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "discovery/free_motion.hpp"
#include "discovery/simulated_structure.hpp"

namespace sysid {

struct ForecastSettings {
  int window = 0;   // rows from which a start is estimated, coefficients held
  int horizon = 0;  // k
  int origins = 0;  // rows of each experiment that forecasts begin at, at most
  SolverSettings solver;
  ExecutionOptions execution;
  std::shared_ptr<ThreadPool> pool;
};

/// Root mean squares over all experiments, per channel of the model, SI; infinite where a simulation is not finite; nothing where
/// nothing is measured.
struct ForecastErrors {
  std::vector<double> sd;  // of what is measured
  std::vector<std::optional<double>> one_step, horizon, free_run;
  std::vector<FreeMotion> runs;  // of each experiment in which one can begin
  double follows = 0;  // [s] from the end of the window until a channel of the first free run is off by 40 % of its sd; its whole
                       // length where none is
};

/// From `origins` rows of each experiment, evenly spread, whose start is estimated from the window that ends there; the free run
/// from the end of the first window to the last row. Windows that hold less than half their share of samples show no start and are
/// left out. experiments: as the model reads them, each with more rows than window + horizon; guess: of the same ones.
ForecastErrors forecast_errors(ValidatedModel const& model, Eigen::VectorXd const& coefficients, std::span<double const> noise_sd,
                               std::span<Experiment const> experiments, StartGuess& guess, ForecastSettings const& settings);

/// How many of some simulations over whole experiments stay finite and within ten times the half range of every channel about its
/// middle, in every experiment. points: [parameters of the model and start states x W] for each experiment.
int bounded_runs(ValidatedModel const& model, std::span<Experiment const> experiments, std::span<LaneArray const> points,
                 ForecastSettings const& settings);

}  // namespace sysid
