// Forms whose rows are samples: every symbol gets a column of smoothed or measured values, terms are read off them.
#pragma once
#include <memory>
#include <span>

#include "regression/column/columns.hpp"

namespace sysid::regression {

// The smoother that makes derivatives of the channels also passes over the inputs, so that both sides of an equation lose the same
// part of the spectrum; under zero_order an input acts at a sample as the mean of what is held before and after it. Errors of rows
// are taken as independent: no covariance is known, and neighbouring rows share samples.

namespace savitzky_golay {
std::span<SettingRow const> settings();
std::string refuse(Settings const& settings, int derivatives);
/// Local polynomials of degree `order` on `window` samples.
std::unique_ptr<Projection> project(Dictionary const&, std::span<Experiment const>, Settings const&);
}  // namespace savitzky_golay

namespace smoothing_spline {
std::span<SettingRow const> settings();
/// One quintic spline per channel, residual as large as its noise; inputs pass the spline of the first channel the equation reads.
std::unique_ptr<Projection> project(Dictionary const&, std::span<Experiment const>, Settings const&);
}  // namespace smoothing_spline

namespace central {
/// Central differences, f'(t) ~ (f(t + h) - f(t - h)) / 2h, one after the other for higher orders but (1, -2, 1) / h^2 for the
/// second; channels and inputs themselves stay as they are.
std::unique_ptr<Projection> project(Dictionary const&, std::span<Experiment const>, Settings const&);
}  // namespace central

namespace measured {
/// Every derivative has a channel of its own.
std::unique_ptr<Projection> project(Dictionary const&, std::span<Experiment const>, Settings const&);
}  // namespace measured

}  // namespace sysid::regression
