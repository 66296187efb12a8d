// Which method integrates a model's equations between the samples of a record, and how accurately: what a task states, every layer
// passes on, and results keep. The table has one row per method, with what it can do; code that needs a capability reads its field
// and does not compare names. What the program runs itself is written in this folder; SUNDIALS is called by simulate/.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "core/setting/settings.hpp"
#include "solver/embedded_method.hpp"
#include "solver/stages.hpp"

namespace sysid {

/// What brings the states from one sample to the next.
enum class Stepping {
  fixed,  // a one-step method expanded into the program: `substeps` equal steps in every interval, all lanes together
  lanes,  // an embedded method in the program's own lanes, each with its own steps
  cvode,  // variable-order BDF for stiff equations, lane by lane (simulate/sundials_cvode.cpp)
  ida,    // the same for implicit and differential-algebraic equations (simulate/sundials_ida.cpp)
};

struct SolverRow {
  std::string_view name;
  std::string_view summary;
  std::span<SettingRow const> settings;
  Stepping stepping;
  int order;                // of its error; 0: variable, or none
  bool adaptive = false;    // chooses its own steps, within the tolerances; else `substeps` equal steps in every interval
  bool in_program = false;  // its step is a part of the compiled program, all lanes together; else lane by lane
  bool stiff = false;       // suits stiff equations: it solves for each step with a Jacobian
  bool implicit = false;    // solves for derivatives that are given implicitly, and for algebraic states
  /// Steps from sample to sample without an error: of equations that are linear in their states (solver/linear_structure.hpp), with
  /// inputs that are straight lines between samples. There is nothing to refine.
  bool exact = false;
  /// The states after one step of a method with fixed steps.
  std::vector<NodeId> (*step)(Stages const&) = nullptr;
  /// The coefficients of an embedded method.
  EmbeddedMethod const& (*embedded)() = nullptr;
};

/// In the order that `sysid list solvers` prints.
std::span<SolverRow const> solvers();
/// nullptr when there is none of that name.
SolverRow const* find_solver(std::string_view name);

/// The first of the table with adaptive steps in the program; for stiff equations; for implicit ones.
SolverRow const& adaptive_solver();
SolverRow const& stiff_solver();
SolverRow const& implicit_solver();
/// Of linear equations.
SolverRow const& exact_solver();

/// Stands for the size of a state that has never moved, so that its error of 0 may be divided by something: far below any quantity
/// in any unit, with squares of its inverse still finite.
constexpr double smallest_size = 1e-120;

/// A solver with its settings. Those that its method does not have are left at their defaults.
struct SolverSettings {
  std::string method = "rk4";
  int substeps = 1;        // fixed: steps per sampling interval
  double relative = 1e-8;  // adaptive: error allowed per step, as a part of each state
  double absolute = 0;     // adaptive: error allowed per step near zero, in the state's SI unit; 0: see `near_zero`
  int steps = 10000;       // adaptive: most steps between two samples, the work budget of a solve
  bool as_model = false;   // fixed: the method with its step is a part of the model, and its error none

  SolverRow const& row() const;
  bool fixed_step() const { return !row().adaptive; }
  /// What the tolerance guard compares with: half the step, or a hundredth of the tolerances; itself where it is exact.
  SolverSettings finer() const;
  /// Whether a task may state it: within the limits of the table.
  bool within_limits() const;
  /// What `finer` does, in words: "half the step".
  std::string finer_words() const;
  /// Methods that may do better where this one fails, in words, itself not among them: "`solver = dopri5`, or `solver = cvode` if
  /// the model is stiff"; empty where there is none.
  std::string other_methods() const;
  /// "rk4(substeps = 8)": every setting that the method has, `as_model` where it is set.
  std::string text() const;
  /// The option of a task that asks for it, in its shortest spelling: "substeps = 8", "solver = heun(substeps = 8)".
  std::string option() const;
  /// The settings that its method has, by name, `as_model` where it is set.
  Settings settings() const;
  /// The error allowed near zero for a state whose largest magnitude so far is `reached`: `absolute` where it is given, else
  /// relative * max(reached, smallest_size) / 1000.
  double near_zero(double reached) const;

  friend bool operator==(SolverSettings const&, SolverSettings const&) = default;
};

/// From a table row and values that it allows; back from `settings()`.
SolverSettings make_solver(SolverRow const& row, Settings const& values);

}  // namespace sysid
