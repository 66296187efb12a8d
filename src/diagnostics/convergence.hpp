// Convergence diagnostics after Vehtari, Gelman, Simpson, Carpenter and Buerkner (2021): rank-normalised split R-hat, bulk and tail
// effective sample size, Monte Carlo standard error. Equal to the R package `posterior` on recorded draws.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/fourier.hpp"
#include "core/numeric/statistics.hpp"
#include "result/draws.hpp"
#include "result/summary.hpp"

namespace sysid {

/// Of one column of the draws, chain by chain.
ChainValues chains_of(Draws const& draws, std::size_t column);

/// NaN for constant or non-finite draws, as `posterior` returns NA.
double rhat(ChainValues const& draws);
double ess_bulk(ChainValues const& draws);
double ess_tail(ChainValues const& draws);
double ess_mean(ChainValues const& draws);
double mcse_mean(ChainValues const& draws);

/// What diagnostics of equally many draws have in common, made when it is first asked for.
class ConvergenceTables {
 public:
  /// Normal scores of the ranks of so many draws: of whole ranks, from 0 to `count`, then of those half above them. NaN: not
  /// computed yet.
  std::vector<double>& scores(std::size_t count);
  /// Long enough for the autocovariance of so many draws.
  Fourier const& fourier(std::size_t draws);

 private:
  std::vector<double> scores_;
  std::optional<Fourier> fourier_;
};

/// tables: of summaries of other quantities.
Summary summarise(std::string name, std::string unit, ChainValues const& draws, ConvergenceTables& tables);
Summary summarise(std::string name, std::string unit, ChainValues const& draws);

}  // namespace sysid
