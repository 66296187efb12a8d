// Information criteria and predictive scores of a finished fit.
#pragma once
#include "app/fit/fit_checks.hpp"
#include "result/criteria.hpp"

namespace sysid {

/// Its ledger `extra` counts the simulations.
Criteria criteria_of(FinishedFit& fit);

}  // namespace sysid
