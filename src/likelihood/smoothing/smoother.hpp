// The smoothed states and disturbances along a record, for given parameters.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "likelihood/smoothing/smoothing_program.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// Declared units.
struct SmoothedName {
  std::string name, unit;
  bool average = false;  // at each sample the mean from there to the next, which the last one has not
};

class Smoother {
 public:
  /// start_rows > 0: the compiled model has a free start, fitted to the experiment's first rows.
  Smoother(std::shared_ptr<SmoothingProgram const> smoothing, Experiment const& experiment, SolverSettings const& solver,
           int start_rows, ExecutionOptions options);

  std::vector<SmoothedName> const& quantities() const { return quantities_; }
  int samples() const { return simulator_.schedule().samples(); }

  /// Mean and sd of each quantity along the record, given a parameter vector; declared units, [quantities x samples].
  struct Path {
    bool solved = false;  // else the others are empty
    std::vector<double> mean, sd;
  };
  /// parameters: of the model, SI [parameters x W]. Path w depends on column w alone.
  std::vector<Path> run(ConstLanes parameters) const;

 private:
  Path path(ConstLanes parameters, ConstLanes records, int lane) const;
  void add_derived(ConstLanes parameters, int lane, SmoothedPath const& smoothed, Path& path) const;
  int at_once(int width) const;

  std::shared_ptr<SmoothingProgram const> smoothing_;
  std::shared_ptr<ThreadPool> pool_;
  Simulator simulator_;
  std::unique_ptr<StartState> start_;
  std::vector<SmoothedName> quantities_;
  std::vector<double> lengths_;  // of the intervals
};

}  // namespace sysid
