// A solver of one trajectory that chooses its own steps, and the strategy that runs one for each lane of a block.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "simulate/lane_equations.hpp"
#include "simulate/stepper.hpp"

namespace sysid {

/// Times are those of LaneEquations. The equations are set to the lane and interval before every call.
class LaneSolver {
 public:
  virtual ~LaneSolver() = default;
  /// Makes the algebraic states satisfy the constraints at `time`; nothing to do without any.
  virtual std::optional<StepFailure> make_consistent(double, std::span<double>) { return std::nullopt; }
  /// Told before each interval, which ends at `end`, where it begins.
  virtual void enter(double time, double end, std::span<double const> states) = 0;
  /// Begins anew from `states`, which satisfy the constraints.
  virtual std::optional<StepFailure> restart(double time, std::span<double const> states) = 0;
  /// To `time`, never beyond it; writes the states there. Fails soon where the caller wants to stop.
  virtual std::optional<StepFailure> advance(double time, std::span<double> states) = 0;
};

/// The strategies of sundials_cvode.cpp and sundials_ida.cpp.
std::unique_ptr<Stepper> make_cvode_steps(LaneFile const& file);
std::unique_ptr<Stepper> make_ida_steps(LaneFile const& file);

/// Runs a solver for each lane, one lane after the other. A solver is restarted where the right-hand side jumps (Schedule::jumps),
/// where parameters were changed, and nowhere else; it never steps across a sample.
class LaneSolvers : public Stepper {
 public:
  using Make = std::function<std::unique_ptr<LaneSolver>(LaneEquations&, SolverSettings const&, bool (*stopped)())>;
  LaneSolvers(LaneFile const& file, Make const& make);

  void start() override;
  void parameters_changed() override;
  void step(int sample) override;
  std::optional<StepFailure> failure(int lane) const override { return lanes_[static_cast<std::size_t>(lane)].failure; }

 private:
  struct Lane {
    std::unique_ptr<LaneSolver> solver;
    std::optional<StepFailure> failure;
    bool fresh = true;  // to be restarted at the next step
  };
  void make_consistent(int sample);
  bool stopped() const { return file_.stopped != nullptr && file_.stopped(); }
  void load(int lane);
  void store(int lane);

  LaneFile file_;
  LaneEquations equations_;
  std::vector<Lane> lanes_;
  std::vector<double> states_;  // of the lane at work
  int sample_ = -1;             // where the states are; -1: not started
};

}  // namespace sysid
