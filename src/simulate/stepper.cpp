// Fixed steps, and the choice among strategies.
#include "simulate/stepper.hpp"

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "simulate/adaptive_lanes.hpp"
#include "simulate/lane_solver.hpp"

namespace sysid {
namespace {

/// The program's own step section, once per substep.
class FixedSteps : public Stepper {
 public:
  explicit FixedSteps(LaneFile const& file) : file_(file) {}

  void step(int sample) override {
    int const width = file_.program.step.uniforms.kernel.outputs;
    for (int substep = 0; substep < file_.schedule.solver().substeps; ++substep) {
      file_.load_row(file_.schedule.step_row(sample, substep), width);
      run(*file_.program.step.linked, file_.executor, file_.file);
    }
  }

 private:
  LaneFile file_;
};

}  // namespace

void LaneFile::load_row(double const* values, int width) const { std::copy(values, values + width, row); }

std::unique_ptr<Stepper> make_stepper(LaneFile const& file) {
  switch (file.schedule.solver().row().stepping) {
    case Stepping::fixed:
      return std::make_unique<FixedSteps>(file);
    case Stepping::lanes:
      return make_adaptive_lanes(file);
    case Stepping::cvode:
      return make_cvode_steps(file);
    case Stepping::ida:
      return make_ida_steps(file);
  }
  throw InternalError("a solver without a strategy");
}

double work_of_lengths(SimulationProgram const& program, Schedule const& schedule) {
  int const lengths = schedule.lengths().count();
  return lengths == 1 ? 0 : static_cast<double>(program.prologue.code.size() + program.reverse.values.code.size()) * lengths;
}

double work_per_sample(SimulationProgram const& program, Schedule const& schedule) {
  SolverSettings const& solver = schedule.solver();
  if (solver.fixed_step())
    return static_cast<double>(program.step.code.size() + program.reverse.step.code.size()) * solver.substeps +
           work_of_lengths(program, schedule) / std::max(1, schedule.samples());
  if (solver.row().in_program) return 2 * static_cast<double>(program.step.code.size());  // attempts, roughly
  // Some twenty steps of two evaluations each, and what the solver does itself.
  EquationKernels const& equations = program.equations;
  return 20 * (2 * static_cast<double>(equations.rates.code.size()) + 200 * equations.states);
}

int grain(SolverSettings const& solver) { return solver.row().in_program ? 4 : 1; }

int least_lanes(SolverSettings const& solver) { return solver.row().in_program ? 16 : 4; }

}  // namespace sysid
