// What a model predicts at the scored samples of its experiments, without noise, and how large the noise there is: the view that
// asks what data can tell, before there is any fit.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

class Output {
 public:
  /// experiments: those of the space, in its order. start_rows > 0: the compiled model has a free start, fitted to the first rows
  /// of each experiment. pool: shared by many, or nullptr.
  Output(std::shared_ptr<CompiledModel const> compiled, std::shared_ptr<ParameterSpace const> space,
         std::vector<Experiment> const& experiments, SolverSettings const& solver, int start_rows, ExecutionOptions options,
         std::shared_ptr<ThreadPool> pool);

  /// The samples that the likelihood sums, experiment by experiment, channel by channel; R of them. measured: SI.
  struct Place {
    int experiment, channel, sample;
    double measured;
  };
  std::vector<Place> const& places() const { return places_; }
  /// Rows of a point: those of the space, then, where the start is free, the first state of each experiment; all SI.
  int point_rows() const { return static_cast<int>(space_->rows().size()) + static_cast<int>(parts_.size()) * start_states_; }

  /// Completes points [point_rows x W] of which the rows of the space are given: estimates the first states.
  void start(Lanes points) const;
  /// Where the noise of each place is centred, [R x W], SI, for points [point_rows x W]; NaN where a solve failed.
  void centres(ConstLanes points, Lanes out) const;
  /// The noise of each place [R], as the standard deviation of the normal that is as sharp there: s with deviance (d/s)^2 for a
  /// sample d off the centre, d = s/10. NaN where the noise has no such width. point: one lane.
  std::vector<double> noise(ConstLanes point) const;
  /// Root mean square of each state along each record, [experiments x states]; point: one lane.
  std::vector<double> state_sizes(ConstLanes point) const;

 private:
  struct Part {
    Simulator simulator;
    std::shared_ptr<StartState const> start;  // absent unless free
    int samples = 0;                          // up to the last scored one
    std::size_t first = 0, count = 0;         // its places
    bool predicts = false;                    // a draw of the random states is added, given the rows of `corrects`
  };
  int records_per_sample() const { return static_cast<int>(compiled_->records.size()); }
  LaneArray parameters(ConstLanes points, int experiment) const;
  LaneArray records(ConstLanes points, int experiment, std::vector<Outcome>& outcome) const;
  /// Adds to the centres, lane by lane, one draw of the random states, from streams that are always the same.
  void add_spread(ConstLanes records, Part const& part, int first, Lanes out) const;
  void add_noise(LaneArray const& records, Part const& part, int channel, std::vector<double>& out) const;

  std::shared_ptr<CompiledModel const> compiled_;
  std::shared_ptr<ParameterSpace const> space_;
  int start_states_ = 0;  // per experiment
  std::vector<Part> parts_;
  std::vector<Place> places_;
  std::vector<int>
      centre_row_;  // per channel: its row among the records of a sample; the arguments of its noise, as recorded, follow
  std::vector<Kernel> deviance_;  // per channel: these arguments, sample -> deviance
};

/// How a model's parameter comes into its data.
enum class ParameterRole {
  response,  // states, their start, an equation or the centre of a channel depend on it
  noise,     // only the noise around the centre does
  prior,     // only other parameters' priors do
  derived,   // only derived quantities do, which no data measure
  none,
};
std::vector<ParameterRole> parameter_roles(Model const& model);
/// Whether each parameter is the size of a noise, of a disturbance or of the scatter of others, and nothing else.
std::vector<bool> sizes_alone(Model const& model);

}  // namespace sysid
