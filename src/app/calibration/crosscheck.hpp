// `sysid crosscheck`: a fit by two back ends, and how far their posteriors differ in Monte Carlo standard errors.
#pragma once
#include <string>

#include "app/session/session.hpp"

namespace sysid {

struct CrosscheckOptions {
  std::string task;     // empty: all fit tasks
  std::string against;  // the other back end; empty: one that suits
};

/// Compares the fit tasks that are asked for, in order, each into a folder of its name. The worst exit code; UserError where there
/// is nothing to compare.
ExitCode crosscheck(Session& session, CrosscheckOptions const& options);

}  // namespace sysid
