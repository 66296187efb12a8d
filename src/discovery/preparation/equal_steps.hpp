// Records of unequal steps, or with missing samples, as the regression reads them: interpolated.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "data/experiment.hpp"

namespace sysid {

/// As many rows at equal steps between the first and the last time: channels by cubic splines through what was measured, NaN where
/// no sample lies within two mean steps; inputs by their own rule, a held one by its
/// mean over the step. Samples closer than a thousandth of the mean step are one. Names and the first row stay.
Experiment at_equal_steps(Experiment const& experiment);

/// Fills in up to three missing samples in a row of a channel, by cubic splines through those that were measured; returns whether
/// there were any.
bool fill_missing(Experiment& experiment);

/// The noise of samples at any distinct times: the root mean square of sixth divided differences, each divided by what it is if
/// every sample has an error of sd 1. Nothing where fewer than seven samples are measured.
std::optional<double> noise_at_unequal_steps(std::span<double const> time, std::span<double const> samples);

}  // namespace sysid
