// CVODE: variable-order BDF with Newton's method on the symbolic Jacobian, for stiff equations.
//
//   y' = f(t, y);    sum_i alpha_ni y_(n-i) + h_n beta_n0 f(t_n, y_n) = 0,  orders 1 to 5      Hindmarsh et al. 2005, eq. 2.2
#include <cvode/cvode.h>

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "simulate/sundials_lane.hpp"

namespace sysid {
namespace {

class CvodeLane : public SundialsLane {
 public:
  CvodeLane(SundialsContext context, LaneEquations& equations, SolverSettings const& solver, bool (*stopped)())
      : SundialsLane(std::move(context), equations, solver, stopped),
        errors_(make_vector()),
        memory_(CVodeCreate(CV_BDF, *context_)) {
    if (memory_ == nullptr) throw InternalError("CVodeCreate returned nothing");
    require(CVodeInit(memory_, &right_side, 0, states_.get()), "CVodeInit");
    require(CVodeSetUserData(memory_, static_cast<SundialsLane*>(this)), "CVodeSetUserData");
    require(CVodeSetErrHandlerFn(
                memory_, [](int, char const*, char const*, char*, void*) {}, nullptr),
            "CVodeSetErrHandlerFn");
    require(CVodeWFtolerances(memory_, &weights), "CVodeWFtolerances");
    require(CVodeSetLinearSolver(memory_, linear_.get(), matrix_.get()), "CVodeSetLinearSolver");
    require(CVodeSetJacFn(memory_, &jacobian), "CVodeSetJacFn");
    require(CVodeSetMaxNumSteps(memory_, solver.steps), "CVodeSetMaxNumSteps");
    require(CVodeSetMaxHnilWarns(memory_, -1), "CVodeSetMaxHnilWarns");
  }
  ~CvodeLane() override { CVodeFree(&memory_); }

  std::optional<StepFailure> restart(double time, std::span<double const> states) override {
    std::copy(states.begin(), states.end(), data(states_));
    // CVODE's own first call would say no more than that something failed.
    int const flag = right_side(time, states_.get(), errors_.get(), static_cast<SundialsLane*>(this));
    if (flag == give_up) return given_up(time);
    if (flag != 0) return not_finite();
    require(CVodeReInit(memory_, time, states_.get()), "CVodeReInit");
    return std::nullopt;
  }

  std::optional<StepFailure> advance(double time, std::span<double> states) override {
    require(CVodeSetStopTime(memory_, time), "CVodeSetStopTime");
    bad_time_ = never;
    double reached = 0;
    int const flag = CVode(memory_, time, states_.get(), &reached, CV_NORMAL);
    if (flag < 0 && stopped()) return given_up(reached);
    if (flag < 0) return explain(flag, reached);
    std::copy_n(data(states_), states.size(), states.begin());
    return std::nullopt;
  }

 private:
  static CvodeLane& self(void* lane) { return static_cast<CvodeLane&>(*static_cast<SundialsLane*>(lane)); }

  static int right_side(double time, N_Vector states, N_Vector out, void* lane) {
    CvodeLane& me = self(lane);
    if (me.stopped()) return give_up;
    double const* y = N_VGetArrayPointer(states);
    if (me.equations_.rates(time, y, N_VGetArrayPointer(out))) return 0;
    me.bad_time_ = time;
    std::copy_n(y, me.count(), me.bad_states_.begin());
    return 1;  // a shorter step may do
  }

  static int jacobian(double time, N_Vector states, N_Vector, SUNMatrix out, void* lane, N_Vector, N_Vector, N_Vector) {
    CvodeLane& me = self(lane);
    return me.equations_.jacobian(time, N_VGetArrayPointer(states), SUNDenseMatrix_Data(out)) ? 0 : 1;
  }

  StepFailure explain(int flag, double time) {
    double internal = time, last_step = 0;
    CVodeGetCurrentTime(memory_, &internal);
    CVodeGetLastStep(memory_, &last_step);
    if (blocked(internal, last_step)) return not_finite();
    switch (flag) {
      case CV_FIRST_RHSFUNC_ERR:
      case CV_REPTD_RHSFUNC_ERR:
      case CV_UNREC_RHSFUNC_ERR:
      case CV_RHSFUNC_FAIL:
        return not_finite();
      case CV_TOO_MUCH_WORK:
      case CV_ERR_FAILURE:
      case CV_TOO_MUCH_ACC:
      case CV_TOO_CLOSE:
        CVodeGetEstLocalErrors(memory_, errors_.get());
        return at_worst_state(FailureClass::step_limit, time, errors_.get());
      case CV_CONV_FAILURE:
      case CV_LSETUP_FAIL:
      case CV_LSOLVE_FAIL:
        CVodeGetEstLocalErrors(memory_, errors_.get());
        return at_worst_state(FailureClass::convergence, time, errors_.get());
      case CV_ILL_INPUT:  // the weights are not finite: a state is not
        bad_time_ = time;
        std::copy_n(data(states_), count(), bad_states_.begin());
        return not_finite();
      default:
        throw InternalError("CVode returned " + std::to_string(flag));
    }
  }

  Vector errors_;
  void* memory_;
};

}  // namespace

std::unique_ptr<Stepper> make_cvode_steps(LaneFile const& file) {
  auto const context = std::make_shared<sundials::Context>();
  return std::make_unique<LaneSolvers>(file, [context](LaneEquations& equations, SolverSettings const& solver, bool (*stopped)()) {
    return std::make_unique<CvodeLane>(context, equations, solver, stopped);
  });
}

}  // namespace sysid
