// Findings about the rows of a track, and the verdict.
#pragma once
#include <cmath>
#include <string>

#include "app/tracking/track_report.hpp"

namespace sysid {

/// "`k` fell by 10 % after row 2950, from 1.000 ± 0.004 to 0.902 ± 0.009 N/m".
std::string change_words(GatheredTrack const& gathered, Alarm const& alarm);
/// "the noise of `d` rose to 3.1 times its sd before (3.1 times that of the fit) after row 8000".
std::string noise_words(GatheredTrack const& gathered, NoiseAlarm const& alarm);
std::string restart_words(Restart const& restart);

/// The size of the innovations against what the filter expects; z: of the sum of their squares, which is chi-squared with one
/// degree of freedom for each sample.
struct InnovationSize {
  double ratio, z;
  /// The fit knows its noise to some per cent: less than a tenth is nothing.
  bool odd() const { return std::fabs(z) > 4 && std::fabs(ratio - 1) > 0.1; }
};

InnovationSize innovation_size(GatheredTrack const& gathered);

/// The findings and the verdict.
void add_findings(GatheredTrack const& gathered, Report& report);

}  // namespace sysid
