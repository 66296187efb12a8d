// Residuals that are the same everywhere: an offset, of a sensor or of what moves the system.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "diagnostics/residuals/user_text.hpp"
#include "model/model.hpp"
#include "result/finding.hpp"

namespace sysid {

/// What the mean of a series is, and how much of the misfit it is.
struct OffsetTest {
  double standard_errors = 0;  // of the mean, from 0, by the number of independent samples that the series is worth
  double share = 0;            // of the mean's square in the mean square
  bool white_without = true;   // of a series in time
  bool fires = false;
};

/// Of the mean of a series without gaps, at least two values, correlated in time:
///
///   standard error^2 = (c_0 + 2 sum c_k)/n,   c_k autocovariances without the mean, up to the first pair of lags whose sum is not
///   positive                                                                                            Geyer 1992, section 3.3
///
/// so that a drift, whose samples are worth a few independent ones, is none. Of long series c_k is taken from means of
/// neighbouring samples.
double squared_standard_error(std::span<double const> values);

/// residuals: of unit size, NaN where not scored. ordered: samples follow each other in time.
///
/// The mean is no chance, |mean| > 6 standard errors (`squared_standard_error`), and it is most of the misfit. In time: the
/// residuals are correlated, and without their mean they are white, or their autocovariances over 25 lags have a sum of squares of
/// less than a twentieth. Rows of any order: the mean is more than half of the mean square.
OffsetTest offset_test(std::span<double const> residuals, bool ordered);

/// size: the mean of measured minus predicted samples where the channel is scored, in its declared unit; largest: of those of all
/// experiments, whose offsets one declaration has to cover; several: there are several. Only for a noise that is added, see
/// `offset_can_be_added`.
Finding residual_offset(Model const& model, Channel const& channel, std::string const& experiment, bool several,
                        OffsetTest const& test, double size, double largest, UserText const& text);

/// Whether a constant can be added to what the noise of this channel lies about. Not where states are random: they follow an
/// offset.
bool offset_can_be_added(Model const& model, Channel const& channel);

}  // namespace sysid
