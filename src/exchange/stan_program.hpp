// A fit as a Stan program with its data: the same density of the same parameters, integrated by the same steps.
#pragma once
#include <string>

#include "app/session/session.hpp"

namespace sysid {

struct StanProgram {
  std::string program;  // TASK.stan
  std::string data;     // TASK.data.json
};

/// The program's `target` without the adjustment for its transforms is log prior + log likelihood of the declared parameters in
/// their declared units, all constants kept (log_prior__ + log_likelihood__ of the draws). Data hold what the equations read of the
/// record at each stage of each step, so that any rule between samples is the one of the data block. solver: rk4, with its
/// substeps, or exponential; of models without states it is not read. UserError names what Stan cannot be told: other solvers, an
/// estimated start, equations that are not solved for their derivatives, unknown functions over rows, values remembered from row to
/// row, bounds that depend on parameters, a function that Stan lacks.
StanProgram stan_program(Session& session, Task const& task, SolverSettings const& solver);

}  // namespace sysid
