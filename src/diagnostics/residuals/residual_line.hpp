// Residuals that are the same everywhere, or follow a line in time: an offset or a drift, of a sensor or of what moves the system.
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

/// A line, of values against time.
struct Line {
  double slope = 0, at_zero = 0;
  double at(double time) const { return at_zero + slope * time; }
};
/// By least squares. Both [n], n > 1; level where all times are the same.
Line fitted_line(std::span<double const> time, std::span<double const> values);

/// What line a series follows, and how much of the misfit it is.
struct TrendTest {
  double standard_errors = 0;  // of its slope, from 0
  double share = 0;            // of the line in the mean square
  bool white_without = true;
  bool fires = false;
};

/// The same of a line in time: its slope is no chance, by the standard error of the mean of the series x_i e_i that it is made of
/// (x_i times and e_i residuals without their mean and line), and it is most of what is correlated. time: [N] s.
TrendTest trend_test(std::span<double const> residuals, std::span<double const> time);

/// size: the mean of measured minus predicted samples where the channel is scored, in its declared unit; largest: of those of all
/// experiments, whose offsets one declaration has to cover; several: there are several. Only for a noise that is added, see
/// `offset_can_be_added`.
Finding residual_offset(Model const& model, Channel const& channel, std::string const& experiment, bool several,
                        OffsetTest const& test, double size, double largest, UserText const& text);

/// The line that measured minus predicted samples follow, in the channel's declared unit and the record's unit of time.
struct Trend {
  double slope = 0;
  double largest_slope = 0;  // of all experiments,
  double largest_value = 0;  // and of their lines at time 0 or along the records
  std::string time_unit = "s";
};
/// Of a model in continuous time, where `offset_can_be_added`.
Finding residual_trend(Model const& model, Channel const& channel, std::string const& experiment, bool several,
                       TrendTest const& test, Trend const& trend, UserText const& text);

/// Whether a constant can be added to what the noise of this channel lies about. Not where states are random: they follow an
/// offset.
bool offset_can_be_added(Model const& model, Channel const& channel);

}  // namespace sysid
