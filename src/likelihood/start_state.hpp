// The state at the first sample, fitted per parameter vector to the first rows of the record (`start = estimated(rows = 50)`).
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "likelihood/compiled_model.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// Least squares by Gauss-Newton on the measured channels of the window, each in units of its sd there, or along the whole record
/// where it does not move in the window, from the model's initial values; slopes by finite differences, each perturbation as
/// large as moves the outputs by 1e-4 of their size, whatever the unit of the state. A move that makes the fit worse is halved.
/// Moves are made until one, not among the first two, changes the outputs by no more than 1e-6 of the misfit: a smooth function
/// of the parameters to that precision, the same for any lane. States the window does not determine stay where they are (a ridge
/// of 1e-10 relative). Where no such move is found the state is NaN, so that the simulation from it fails and is counted.
class StartState {
 public:
  /// compiled: with a free start. experiment: begins at the row whose state is wanted; its first `rows` rows are the window.
  StartState(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, int rows, SolverSettings const& solver,
             ExecutionOptions options, std::shared_ptr<ThreadPool> pool = nullptr);

  /// parameters: [parameter_rows x W], SI; reads the model's parameters, writes the rows of the start state.
  void estimate(Lanes parameters) const;

 private:
  struct Search;
  /// Residuals at the place on trial, and their changes by the perturbation of each state: [residuals x states].
  struct Slopes {
    Eigen::VectorXd residual;
    Eigen::MatrixXd change;
  };
  void differences(ConstLanes parameters, std::span<Search* const> searches, std::vector<Slopes>& out) const;
  /// Perturbations that show, from those that the searches begin with; makes the first move of a search where all of them do.
  void find_steps(ConstLanes parameters, std::span<Search> searches) const;
  /// Judges the move on trial and makes the next one.
  void advance(Search& search, Slopes const& slopes) const;
  /// Predicted centres minus samples, weighted: [residuals x W].
  void residuals(ConstLanes parameters, LaneArray& out) const;

  std::shared_ptr<CompiledModel const> compiled_;
  std::vector<int> record_;  // record rows of the channels' centres that are measured in the window
  std::vector<std::vector<double>> samples_;
  std::vector<double> weights_;
  int rows_ = 0;
  double least_effect_ = 0;  // of the first perturbations
  int count_ = 0;            // residuals
  double data_norm_ = 0;
  Simulator simulator_;
};

}  // namespace sysid
