// The loop around an attempt, and the lanes that leave it: arrived, out of budget, or no longer finite.
#include "simulate/adaptive_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "program/embedded.hpp"

namespace sysid {
namespace {

class AdaptiveLanes : public Stepper {
 public:
  explicit AdaptiveLanes(LaneFile const& file)
      : file_(file),
        control_(file.rows(file.program.registers.first_control(), file.program.registers.control)),
        failure_(static_cast<std::size_t>(file.executor.width), FailureClass::non_finite) {}

  void start() override {
    std::fill(failure_.begin(), failure_.end(), FailureClass::non_finite);
    double const first = file_.schedule.samples() > 1 ? file_.schedule.time(1) - file_.schedule.time(0) : 1;
    Lanes const states = file_.states();
    for (int w = 0; w < file_.executor.width; ++w) {
      row(Control::step)[w] = first;
      row(Control::hunts)[w] = 0;
      for (int r = static_cast<int>(Control::rest); r < control_.rows(); ++r) {
        int const state = r - static_cast<int>(Control::rest);
        control_(r, w) = state < states.rows() ? std::fabs(states(state, w)) : 1;  // sides are looked up before the first step
      }
    }
  }

  void step(int sample) override {
    Lanes const states = file_.states();
    double* const position = row(Control::position);
    for (int w = 0; w < file_.executor.width; ++w) {
      bool finite = true;
      for (int i = 0; i < states.rows(); ++i) finite = finite && std::isfinite(states(i, w));
      position[w] = finite ? 0 : 1;  // nothing is tried with a dead lane
      row(Control::aim)[w] = std::numeric_limits<double>::max();
      row(Control::hunts)[w] = 0;
    }
    file_.load_row(file_.schedule.step_row(sample, 0), file_.program.step.uniforms.kernel.outputs);
    int const most = file_.schedule.solver().steps;
    for (int attempts = 0; attempts < most && travelling(position); ++attempts)
      run(*file_.program.step.linked, file_.executor, file_.file);
    for (int w = 0; w < file_.executor.width; ++w) {
      if (position[w] >= 1) continue;
      failure_[static_cast<std::size_t>(w)] = FailureClass::step_limit;
      for (int i = 0; i < states.rows(); ++i) states(i, w) = std::numeric_limits<double>::quiet_NaN();
    }
  }

  FailureClass failure(int lane) const override { return failure_[static_cast<std::size_t>(lane)]; }

 private:
  double* row(Control which) { return &control_(static_cast<int>(which), 0); }
  bool travelling(double const* position) const {
    return std::any_of(position, position + file_.executor.width, [](double p) { return p < 1; });
  }

  LaneFile file_;
  Lanes control_;
  std::vector<FailureClass> failure_;
};

}  // namespace

std::unique_ptr<Stepper> make_adaptive_lanes(LaneFile const& file) { return std::make_unique<AdaptiveLanes>(file); }

}  // namespace sysid
