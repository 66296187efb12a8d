// Convergence diagnostics after Vehtari, Gelman, Simpson, Carpenter and Buerkner (2021): rank-normalised split R-hat, bulk and tail
// effective sample size, Monte Carlo standard error. Equal to the R package `posterior` on recorded draws.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/numeric/statistics.hpp"
#include "result/summary.hpp"

namespace sysid {

/// NaN for constant or non-finite draws, as `posterior` returns NA.
double rhat(ChainValues const& draws);
double ess_bulk(ChainValues const& draws);
double ess_tail(ChainValues const& draws);
double ess_mean(ChainValues const& draws);
double mcse_mean(ChainValues const& draws);

Summary summarise(std::string name, std::string unit, ChainValues const& draws);

}  // namespace sysid
