// What a careful programmer writes for one model without this program: a scalar loop, compiled with -O3 -march=native.
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

}  // namespace baseline
