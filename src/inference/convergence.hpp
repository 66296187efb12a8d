// Convergence diagnostics after Vehtari, Gelman, Simpson, Carpenter and Buerkner (2021): rank-normalised split R-hat, bulk and tail
// effective sample size, Monte Carlo standard error. Equal to the R package `posterior` on recorded draws.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace sysid {

/// draws[c][i]: chain c, iteration i; all chains of one length.
using ChainValues = std::vector<std::vector<double>>;

/// NaN for constant or non-finite draws, as `posterior` returns NA.
double rhat(ChainValues const& draws);
double ess_bulk(ChainValues const& draws);
double ess_tail(ChainValues const& draws);
double ess_mean(ChainValues const& draws);
double mcse_mean(ChainValues const& draws);

struct Summary {
  std::string name, unit;
  double mean, median, sd, mad, q5, q95, rhat, ess_bulk, ess_tail, mcse_mean;
  bool coefficient = false;  // of an unknown function: tables leave it out
};
Summary summarise(std::string name, std::string unit, ChainValues const& draws);

/// The normal's 95 % quantile: how many sds its central 90 % reach to either side.
inline constexpr double normal_quantile_95 = 1.6448536269514722;

/// Quantile of type 7 (R's default), draws need not be sorted.
double quantile(std::vector<double> draws, double probability);
/// The same of draws that rise and are not empty.
double sorted_quantile(std::vector<double> const& sorted, double probability);
/// Quantile of type 6, of draws that rise and are not empty. Between those of 2.5 % and 97.5 % another draw falls with probability
/// 0.95 however few draws there are, from 39 on; between those of type 7, 0.931 with 100.
double predictive_quantile(std::vector<double> const& sorted, double probability);

}  // namespace sysid
