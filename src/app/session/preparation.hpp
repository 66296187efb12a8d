// The state of a fit before its first sample, stored so that a resumed run does not search again.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/backend/backend.hpp"
#include "likelihood/improper_reference.hpp"
#include "likelihood/member_coordinate.hpp"
#include "solver/solver.hpp"

namespace sysid {

struct Preparation {
  SolverSettings solver;
  std::vector<Mode> modes;
  Findings findings;
  Ledger ledger;
  std::vector<MemberCoordinate> standardised;  // members of hierarchies, in whose coordinates the modes are
  std::vector<ImproperReference> references;   // in the place of draws of improper priors
  std::vector<double> moves;                   // of each solver tried: largest move to the next finer one [sd]
  int searched_again = 0;                      // from places that a result has shown to be higher than the modes
};

nlohmann::json store(Preparation const& preparation);
Preparation restore_preparation(nlohmann::json const& stored);

}  // namespace sysid
