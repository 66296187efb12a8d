// The loop around an attempt, and the lanes that leave it: arrived, out of budget, or no longer finite.
#include "simulate/adaptive_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "program/embedded.hpp"
#include "simulate/lane_equations.hpp"
#include "simulate/machine_loop.hpp"
#include "simulate/state_sizes.hpp"

namespace sysid {
namespace {

/// Attempts of a block that take some milliseconds.
constexpr int attempts_between_looks = 256;

class AdaptiveLanes : public Stepper {
 public:
  explicit AdaptiveLanes(LaneFile const& file)
      : file_(file),
        equations_(file.program, file.schedule),
        control_(file.rows(file.program.registers.first_control(), file.program.registers.control)),
        failure_(static_cast<std::size_t>(file.executor.width)),
        attempt_(machine_loop(file.program, file.schedule.solver(), file.executor, native::LoopKind::attempt)) {}

  void start() override {
    std::fill(failure_.begin(), failure_.end(), std::nullopt);
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
    for (int w = 0; w < file_.executor.width; ++w)
      if (sample == 0 || has_unknown_size(w)) find_sizes(sample, w);
    for (int w = 0; w < file_.executor.width; ++w) {
      bool finite = true;
      for (int i = 0; i < states.rows(); ++i) finite = finite && std::isfinite(states(i, w));
      position[w] = finite ? 0 : 1;  // nothing is tried with a dead lane
      row(Control::aim)[w] = std::numeric_limits<double>::max();
      row(Control::hunts)[w] = 0;
    }
    attempt_steps(sample);
    for (int w = 0; w < file_.executor.width; ++w) {
      if (position[w] >= 1) continue;
      failure_[static_cast<std::size_t>(w)] = look_into(sample, w);
      for (int i = 0; i < states.rows(); ++i) states(i, w) = std::numeric_limits<double>::quiet_NaN();
    }
  }

  std::optional<StepFailure> failure(int lane) const override { return failure_[static_cast<std::size_t>(lane)]; }

 private:
  void attempt_steps(int sample) {
    double const* const uniforms = file_.schedule.step_row(sample, 0);
    int const most = file_.schedule.solver().steps;
    if (attempt_ != nullptr) {
      native::Call call;
      call.registers = file_.registers;
      call.steps = uniforms;
      for (int left = most; left > 0 && travelling(row(Control::position)) && !stopped(); left -= call.attempts) {
        call.attempts = std::min(left, attempts_between_looks);
        attempt_(&call);
      }
      return;
    }
    file_.load_row(uniforms, file_.program.step.uniforms.kernel.outputs);
    for (int attempts = 0; attempts < most && travelling(row(Control::position)); ++attempts) {
      if (attempts % attempts_between_looks == 0 && stopped()) return;
      run(*file_.program.step.linked, file_.executor, file_.file);
    }
  }

  bool stopped() const { return file_.stopped != nullptr && file_.stopped(); }
  double* row(Control which) { return &control_(static_cast<int>(which), 0); }
  bool travelling(double const* position) const {
    return std::any_of(position, position + file_.executor.width, [](double p) { return p < 1; });
  }

  // What is remembered has no error.
  bool has_unknown_size(int lane) const {
    int const moving = file_.states().rows() - static_cast<int>(file_.program.source.memories.size());
    for (int i = 0; i < moving; ++i)
      if (control_(static_cast<int>(Control::rest) + i, lane) == 0) return true;
    return false;
  }

  void find_sizes(int sample, int lane) {
    equations_.set_parameters(file_.parameters(), lane);
    equations_.set_interval(sample);
    std::vector<double> states, sizes;
    for (int i = 0; i < file_.states().rows(); ++i) {
      states.push_back(file_.states()(i, lane));
      sizes.push_back(control_(static_cast<int>(Control::rest) + i, lane));
    }
    raise_sizes(equations_, equations_.time(sample), equations_.time(sample + 1), states, file_.schedule.solver(), sizes);
    for (int i = 0; i < file_.states().rows(); ++i)
      control_(static_cast<int>(Control::rest) + i, lane) = sizes[static_cast<std::size_t>(i)];
  }

  // Where a lane got stuck: what is not finite there, else the equation of the state that moves fastest for its size.
  StepFailure look_into(int sample, int lane) {
    LaneEquations& equations = equations_;
    equations.set_parameters(file_.parameters(), lane);
    equations.set_interval(sample);
    double const begin = equations.time(sample), end = equations.time(sample + 1);
    double const time = begin + row(Control::position)[lane] * (end - begin);
    std::vector<double> states, rates(static_cast<std::size_t>(equations.states()));
    for (int i = 0; i < file_.states().rows(); ++i) states.push_back(file_.states()(i, lane));
    if (auto const node = equations.not_finite(time, states)) return {FailureClass::non_finite, time, node};
    equations.rates(time, states.data(), rates.data());
    int fastest = 0;
    double most = 0;
    for (int i = 0; i < static_cast<int>(rates.size()); ++i) {
      double const reached = control_(static_cast<int>(Control::rest) + i, lane);
      double const speed = std::fabs(rates[static_cast<std::size_t>(i)]) / std::max(reached, 1e-300);
      if (speed > most) most = speed, fastest = i;
    }
    return {FailureClass::step_limit, time, equations.equation(fastest)};
  }

  LaneFile file_;
  LaneEquations equations_;  // where sizes are looked up, and failures looked into
  Lanes control_;
  std::vector<std::optional<StepFailure>> failure_;
  native::Function attempt_;  // null: interpreted
};

}  // namespace

std::unique_ptr<Stepper> make_adaptive_lanes(LaneFile const& file) { return std::make_unique<AdaptiveLanes>(file); }

}  // namespace sysid
