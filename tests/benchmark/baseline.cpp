// The hand-written loops; compiled for the processor at hand, contraction allowed: nothing is held back.
#include "baseline.hpp"

#include <cmath>

namespace baseline {

double duffing(Record const& record, double m, double c, double k, double k3) {
  double const h = record.h, inverse_m = 1 / m;
  auto const acceleration = [=](double y, double v, double x) { return (x - c * v - y * (k + k3 * y * y)) * inverse_m; };
  double y = 0, v = 0, sum = 0;
  for (std::size_t i = 0; i < record.measured.size(); ++i) {
    double const r = record.measured[i] - y;
    sum += r * r;
    if (i + 1 == record.measured.size()) break;
    double const x0 = record.input[i], x2 = record.input[i + 1], x1 = 0.5 * (x0 + x2);
    double const a1 = acceleration(y, v, x0);
    double const y2 = y + 0.5 * h * v, v2 = v + 0.5 * h * a1, a2 = acceleration(y2, v2, x1);
    double const y3 = y + 0.5 * h * v2, v3 = v + 0.5 * h * a2, a3 = acceleration(y3, v3, x1);
    double const y4 = y + h * v3, v4 = v + h * a3, a4 = acceleration(y4, v4, x2);
    y += h / 6 * (v + 2 * (v2 + v3) + v4);
    v += h / 6 * (a1 + 2 * (a2 + a3) + a4);
  }
  return sum;
}

double bouc_wen(Record const& record, double m, double c, double A, double alpha, double beta) {
  double const h = record.h, inverse_m = 1 / m;
  auto const acceleration = [=](double v, double z, double x) { return (x - c * v - z) * inverse_m; };
  auto const restoring = [=](double v, double z) { return v * (A - beta * z * z) - alpha * std::abs(v) * std::abs(z) * z; };
  double y = 0, v = 0, z = 0, sum = 0;
  for (std::size_t i = 0; i < record.measured.size(); ++i) {
    double const r = record.measured[i] - y;
    sum += r * r;
    if (i + 1 == record.measured.size()) break;
    double const x0 = record.input[i], x2 = record.input[i + 1], x1 = 0.5 * (x0 + x2);
    double const a1 = acceleration(v, z, x0), d1 = restoring(v, z);
    double const v2 = v + 0.5 * h * a1, z2 = z + 0.5 * h * d1;
    double const a2 = acceleration(v2, z2, x1), d2 = restoring(v2, z2);
    double const v3 = v + 0.5 * h * a2, z3 = z + 0.5 * h * d2;
    double const a3 = acceleration(v3, z3, x1), d3 = restoring(v3, z3);
    double const v4 = v + h * a3, z4 = z + h * d3;
    double const a4 = acceleration(v4, z4, x2), d4 = restoring(v4, z4);
    y += h / 6 * (v + 2 * (v2 + v3) + v4);
    v += h / 6 * (a1 + 2 * (a2 + a3) + a4);
    z += h / 6 * (d1 + 2 * (d2 + d3) + d4);
  }
  return sum;
}

}  // namespace baseline
