// Whether a record that a fit does not explain is explained if two of its columns are exchanged, or one has the other sign.
#pragma once
#include "app/fit/fit_checks.hpp"

namespace sysid {

/// Whether what was found may be the doing of exchanged columns or of a wrong sign.
bool doubts_columns(Finding const& finding);

/// `column_used_twice`, a warning, of a fit with such findings: the model is fitted, by a short search from draws of the
/// prior, to the record with two columns exchanged, one of them that of an input. With G the log likelihood above that of a
/// constant with its own noise, per scored sample, and so exp(-2 G) about the unexplained share of the variance, it is reported
/// where
///
///   exp(-2 G) < 0.05   and   exp(-2 G) < exp(-2 G0)/4,   G0 that of the fit
///
/// and nothing is tried where exp(-2 G0) < 0.003: a record that is explained so far is not one with exchanged columns. In the same
/// way `sign_reversed`, a warning, with the sign of an input reversed, or of one of several channels. The best of all is reported,
/// if a search of the record as it is read leaves four times as much, too. Nothing of models without dynamics, whose equations hold
/// in both directions, with random states, unknown functions or noise that is not normal, of models that read measured samples, nor
/// of more than six pairs; and no pair after which a channel is one sinusoid.
Findings check_other_readings(FinishedFit& fit);

}  // namespace sysid
