// IDA: variable-order BDF for implicit and differential-algebraic equations of index 1.
//
//   F(t, y, y') = (y_d' - f(t, y), g(t, y)) = 0;   Newton's matrix  dF/dy + c dF/dy'             Hindmarsh et al. 2005, eq. 2.8
//
// y_d: differential states, then the algebraic ones y_a, which g determines: dg/dy_a is regular (index 1).
#include <ida/ida.h>

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "simulate/algebraic_states.hpp"
#include "simulate/sundials_lane.hpp"

namespace sysid {
namespace {

class IdaLane : public SundialsLane {
 public:
  IdaLane(SundialsContext context, LaneEquations& equations, SolverSettings const& solver, bool (*stopped)())
      : SundialsLane(std::move(context), equations, solver, stopped),
        rates_(make_vector()),
        errors_(make_vector()),
        evaluated_(count()),
        algebraic_(equations, solver),
        memory_(IDACreate(*context_)) {
    if (memory_ == nullptr) throw InternalError("IDACreate returned nothing");
    require(IDAInit(memory_, &residual, 0, states_.get(), rates_.get()), "IDAInit");
    require(IDASetUserData(memory_, static_cast<SundialsLane*>(this)), "IDASetUserData");
    require(IDASetErrHandlerFn(
                memory_, [](int, char const*, char const*, char*, void*) {}, nullptr),
            "IDASetErrHandlerFn");
    require(IDAWFtolerances(memory_, &weights), "IDAWFtolerances");
    require(IDASetLinearSolver(memory_, linear_.get(), matrix_.get()), "IDASetLinearSolver");
    require(IDASetJacFn(memory_, &jacobian), "IDASetJacFn");
    require(IDASetMaxNumSteps(memory_, solver.steps), "IDASetMaxNumSteps");
    // Algebraic states jump where inputs do: their error control would answer a jump of their rate with needless short steps.
    Vector const differential = make_vector();
    for (std::size_t i = 0; i < count(); ++i) data(differential)[i] = is_differential(i) ? 1 : 0;
    require(IDASetId(memory_, differential.get()), "IDASetId");
  }
  ~IdaLane() override { IDAFree(&memory_); }

  std::optional<StepFailure> make_consistent(double time, std::span<double> states) override {
    return algebraic_.solve(time, states);
  }

  std::optional<StepFailure> restart(double time, std::span<double const> states) override {
    std::copy(states.begin(), states.end(), data(states_));
    if (!evaluate(time, states_.get())) return not_finite();
    for (std::size_t i = 0; i < count(); ++i) data(rates_)[i] = is_differential(i) ? evaluated_[i] : 0;
    require(IDAReInit(memory_, time, states_.get(), rates_.get()), "IDAReInit");
    return std::nullopt;
  }

  std::optional<StepFailure> advance(double time, std::span<double> states) override {
    require(IDASetStopTime(memory_, time), "IDASetStopTime");
    bad_time_ = never;
    double reached = 0;
    int const flag = IDASolve(memory_, time, &reached, states_.get(), rates_.get(), IDA_NORMAL);
    if (flag < 0 && stopped()) return given_up(reached);
    if (flag < 0) return explain(flag, reached);
    std::copy_n(data(states_), states.size(), states.begin());
    return std::nullopt;
  }

 private:
  static IdaLane& self(void* lane) { return static_cast<IdaLane&>(*static_cast<SundialsLane*>(lane)); }
  bool is_differential(std::size_t i) const { return static_cast<int>(i) < equations_.differential(); }

  bool evaluate(double time, N_Vector states) {
    double const* y = N_VGetArrayPointer(states);
    if (equations_.rates(time, y, evaluated_.data())) return true;
    bad_time_ = time;
    std::copy_n(y, count(), bad_states_.begin());
    return false;
  }

  static int residual(double time, N_Vector states, N_Vector rates, N_Vector out, void* lane) {
    IdaLane& me = self(lane);
    if (me.stopped()) return give_up;
    if (!me.evaluate(time, states)) return 1;  // a shorter step may do
    double const* rate = N_VGetArrayPointer(rates);
    double* r = N_VGetArrayPointer(out);
    for (std::size_t i = 0; i < me.count(); ++i) r[i] = me.is_differential(i) ? rate[i] - me.evaluated_[i] : me.evaluated_[i];
    return 0;
  }

  static int jacobian(double time, double c, N_Vector states, N_Vector, N_Vector, SUNMatrix out, void* lane, N_Vector, N_Vector,
                      N_Vector) {
    IdaLane& me = self(lane);
    double* column = SUNDenseMatrix_Data(out);
    if (!me.equations_.jacobian(time, N_VGetArrayPointer(states), column)) return 1;
    for (std::size_t j = 0; j < me.count(); ++j, column += me.count()) {
      for (std::size_t i = 0; i < me.count(); ++i)
        if (me.is_differential(i)) column[i] = -column[i];
      if (me.is_differential(j)) column[j] += c;
    }
    return 0;
  }

  StepFailure explain(int flag, double time) {
    IDAGetEstLocalErrors(memory_, errors_.get());
    double internal = time, last_step = 0;
    IDAGetCurrentTime(memory_, &internal);
    IDAGetLastStep(memory_, &last_step);
    if (blocked(internal, last_step)) return not_finite();
    switch (flag) {
      case IDA_REP_RES_ERR:
      case IDA_RES_FAIL:
      case IDA_FIRST_RES_FAIL:
        return not_finite();
      case IDA_TOO_MUCH_WORK:
      case IDA_ERR_FAIL:
      case IDA_TOO_MUCH_ACC:
        return at_worst_state(FailureClass::step_limit, time, errors_.get());
      case IDA_CONV_FAIL:
      case IDA_LSETUP_FAIL:
      case IDA_LSOLVE_FAIL:
      case IDA_NLS_FAIL:
        return at_worst_state(FailureClass::convergence, time, errors_.get());
      case IDA_ILL_INPUT:  // the weights are not finite: a state is not
        bad_time_ = time;
        std::copy_n(data(states_), count(), bad_states_.begin());
        return not_finite();
      default:
        throw InternalError("IDASolve returned " + std::to_string(flag));
    }
  }

  Vector rates_, errors_;
  std::vector<double> evaluated_;
  AlgebraicStates algebraic_;
  void* memory_;
};

}  // namespace

std::unique_ptr<Stepper> make_ida_steps(LaneFile const& file) {
  auto const context = std::make_shared<sundials::Context>();
  return std::make_unique<LaneSolvers>(file, [context](LaneEquations& equations, SolverSettings const& solver, bool (*stopped)()) {
    return std::make_unique<IdaLane>(context, equations, solver, stopped);
  });
}

}  // namespace sysid
