// From the filtered states at each sample to the smoothed ones, which use the whole record: the smoother of Rauch, Tung and
// Striebel, for one parameter vector.
#pragma once
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// Where a sample's numbers are among its records; -1: they are 0 whatever the parameters.
struct SmoothingRecords {
  int states = 0, noises = 0;
  int count = 0;  // per sample
  // Before the sample is seen, [n] and [n x n].
  std::vector<int> mean_before, covariance_before;
  // The covariance with the states at the sample before [n x n], with the noises summed up since [noises x n], and the variance of
  // those sums [noises].
  std::vector<int> past, noise, sum;
  // After it has been seen.
  std::vector<int> mean_after, covariance_after;
};

struct SmoothedPath {
  std::vector<double> mean;        // [samples x n]
  std::vector<double> covariance;  // [samples x n n]
  /// [noises x samples] the mean of each noise from a sample to the next, and its variance; NaN at the last sample.
  std::vector<double> average, average_variance;
};

/// With m-, P- before and m+, P+ after a sample, C = cov(x_(k+1), x_k), u = cov(x_(k+1), s) and v = var s of the noise s summed up
/// between the two, from the last sample, where x^ = m+ and P^ = P+, backwards
///   J = C' (P-_(k+1))^-1,  x^_k = m+_k + J (x^_(k+1) - m-_(k+1)),  P^_k = P+_k + J (P^_(k+1) - P-_(k+1)) J'
///   g = (P-_(k+1))^-1 u,   s^ = g' (x^_(k+1) - m-_(k+1)),  var s^ = v - u' g + g' P^_(k+1) g
///                                                                  Rauch, Tung & Striebel 1965; Sarkka 2013, section 8
/// Where P- is singular, as after a known start, any inverse on its range does, since C and u lie in it.
///
/// records: row i count + r is record r of sample i, of which `lane` is read. lengths: [samples - 1] of the intervals; 1 in
/// discrete time.
SmoothedPath smooth(SmoothingRecords const& layout, ConstLanes records, int lane, std::vector<double> const& lengths);

}  // namespace sysid
