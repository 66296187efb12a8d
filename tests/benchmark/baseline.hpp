// What a careful programmer writes for one model without this program: a scalar loop, and one over vectors; -O3 -march=native.
#pragma once
#include <vector>

namespace baseline {

/// A record: input between samples is linear, so its middle is the mean of two samples.
struct Record {
  double h;
  std::vector<double> input, measured;
};

/// Sum of squared residuals of the displacement over all samples; one RK4 step per sample.
double duffing(Record const& record, double m, double c, double k, double k3);
/// n = 2.
double bouc_wen(Record const& record, double m, double c, double A, double alpha, double beta);

/// Lanes of the widest vectors of the processor that this was compiled for.
int simd_lanes();
/// The same for many parameter vectors at once: a row of `lanes` values for each parameter, in the order of the arguments above;
/// sums: [lanes]. A multiple of simd_lanes().
void duffing_simd(Record const& record, double const* const* parameters, int lanes, double* sums);
void bouc_wen_simd(Record const& record, double const* const* parameters, int lanes, double* sums);
/// With the exponent n as the sixth parameter.
void bouc_wen_power_simd(Record const& record, double const* const* parameters, int lanes, double* sums);

}  // namespace baseline
