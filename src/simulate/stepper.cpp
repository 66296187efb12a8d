// Fixed steps, and the choice among strategies.
#include "simulate/stepper.hpp"

#include <algorithm>

#include "core/diagnostic.hpp"

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

FailureClass Stepper::failure(int) const { return FailureClass::non_finite; }

std::unique_ptr<Stepper> make_stepper(LaneFile const& file) {
  switch (file.schedule.solver().row().stepping) {
    case Stepping::fixed:
      return std::make_unique<FixedSteps>(file);
  }
  throw InternalError("a solver without a strategy");
}

double work_per_sample(SimulationProgram const& program, SolverSettings const& solver) {
  return static_cast<double>(program.step.code.size()) * solver.substeps;
}

}  // namespace sysid
