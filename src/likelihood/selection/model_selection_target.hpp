// Candidate models compiled for their data: simulations of all of them share lanes, threads and the distance.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/model_target.hpp"
#include "likelihood/selection/distance.hpp"
#include "likelihood/selection/selection_target.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// One of them, with random states or without. space: over the model without its noise parameters; experiments: those of the space,
/// in its order.
struct SelectionCandidate {
  std::string name;
  double probability = 0;
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<ParameterSpace const> space;
  std::vector<Experiment> experiments;
  DistanceMeasure measure;
  TargetOptions options;  // its execution is that of the whole set's first
};

class ModelSelectionTarget : public SelectionTarget {
 public:
  explicit ModelSelectionTarget(std::vector<SelectionCandidate> candidates);
  ~ModelSelectionTarget() override;

  int size() const override { return static_cast<int>(candidates_.size()); }
  std::string const& name(int model) const override { return at(model).name; }
  double prior_probability(int model) const override { return at(model).probability; }
  std::span<ParameterInfo const> parameters(int model) const override { return at(model).space->infos(); }
  void sample_prior(int model, StreamKey key, Lanes theta) const override { at(model).space->sample_prior(key, theta); }
  void log_prior(int model, ConstLanes theta, std::span<double> out, bool jacobian) const override {
    at(model).space->log_prior(theta, out, jacobian);
  }
  void constrain(int model, ConstLanes theta, Lanes declared) const override { at(model).space->constrain(theta, declared); }
  void unconstrain(int model, ConstLanes declared, Lanes theta) const override { at(model).space->unconstrain(declared, theta); }
  void distances(std::span<Batch const> batches, double bound) const override;
  std::pair<std::string, double> failure(int model, ConstLanes theta) const override;
  void parallel(int tasks, std::function<void(int)> const& task) const override;

  Distance const& distance(int model) const;

 private:
  struct Part;
  struct Running;
  SelectionCandidate const& at(int model) const { return candidates_[static_cast<std::size_t>(model)]; }
  LaneArray simulation_parameters(int model, int experiment, ConstLanes theta) const;
  /// Of a candidate with random states: adds to the sums [channels x W], SI. Every theta has disturbances of its own, the same
  /// whenever it is asked for.
  void simulate_drawn(int model, int experiment, ConstLanes theta, Lanes sums, std::span<Outcome> outcome) const;
  void add_drawn(Batch const& batch, int experiment, double bound, Running& now) const;

  std::vector<SelectionCandidate> candidates_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<Part> parts_;
};

}  // namespace sysid
