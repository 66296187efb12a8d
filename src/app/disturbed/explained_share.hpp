// What the equations of a fit explain of its record by themselves, without a disturbance.
#pragma once
#include <filesystem>
#include <optional>

#include "app/session/session.hpp"

namespace sysid {

/// Of the variance of the channels, from 0 to 1: the mean over channels and experiments of 1 - sum (y - y*)^2 / sum (y - mean y)^2,
/// where y* runs freely; the median over draws. fit: without a disturbance; results: the folder whose draws are taken, of this fit
/// or of one that has all of its parameters. Nothing where such draws cannot be simulated, or channels do not change.
std::optional<double> explained_share(Session& like, Task const& fit, std::filesystem::path const& results);

/// The same at the draws of the fit without the disturbance and of that with it.
struct ExplainedShares {
  std::optional<double> without, with;

  /// Whether the disturbance has taken the place of what the equations explained.
  bool replaced() const;
};

}  // namespace sysid
