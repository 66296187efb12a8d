// Whether data lie within the bands of a prediction.
#pragma once
#include "result/report.hpp"

namespace sysid {

/// Whether some channel leaves its 95 % band far more often than it should: a warning for each. Errors of parameters and of random
/// states last from sample to sample, so that the samples are worth fewer independent ones:
///
///   n_e = n / (1 + 2 sum (1 - k/n) min(|r_k|, l)^2),   r_k autocorrelations of the errors above 2/sqrt(n - k), k up to n/2,
///
/// l the part of the bands' variance that is not noise. Both the share outside the band and the mean square of the errors in sds of
/// the band are judged by n_e, each at 0.001 (0.01 where less than half of the samples are inside), after the share of all n was
/// found beyond chance; errors in logarithms where the band is skewed as that of a log-normal quantity is. fed_back: the noise of a
/// sample shows in later ones, which a free run leaves out.
bool add_coverage(Report& report, bool fed_back);

}  // namespace sysid
