// Whether what a refit leaves of the motion is correlated in time, as the fit of the written model would find.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "discovery/simulated_structure.hpp"
#include "likelihood/segments/shooting.hpp"

namespace sysid {

struct ResidualMemory {
  std::size_t channel = 0;  // of the model
  std::size_t experiment = 0;
  int outside = 0, lags = 0;  // of these lags so many are outside the 99 % band
};

/// Series that are not white, over all channels and experiments of a structure at its fit; a residual below 1e-5 of the motion is
/// not tested. experiments: as the model reads them, in the segments of the fit. noise: of samples where it is not alike in all, by
/// which residuals are divided; with the channels of the model.
std::vector<ResidualMemory> residual_memory(ValidatedModel const& model, ShootingFit const& fit,
                                            std::span<Experiment const> experiments, std::vector<Segment> const& segments,
                                            SolverSettings const& solver, NoiseShape const& noise,
                                            ExecutionOptions const& execution, std::shared_ptr<ThreadPool> const& pool);

}  // namespace sysid
