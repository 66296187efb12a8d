// Stages of Fourier transforms, in loops that the compiler turns into vectors (compiled for the vectors of the processor, see
// CMakeLists.txt).
#include "core/numeric/fourier_stages.hpp"

namespace sysid::fourier_stages {
namespace {

/// One block: `half` butterflies of a and b with factors c + i s, none of which overlap.
void block_in_frequency(double* __restrict ar, double* __restrict ai, double* __restrict br, double* __restrict bi,
                        double const* __restrict c, double const* __restrict s, long half) {
  for (long k = 0; k < half; ++k) {
    double const dr = ar[k] - br[k], di = ai[k] - bi[k];
    ar[k] += br[k];
    ai[k] += bi[k];
    br[k] = dr * c[k] - di * s[k];
    bi[k] = dr * s[k] + di * c[k];
  }
}

void block_in_time(double* __restrict ar, double* __restrict ai, double* __restrict br, double* __restrict bi,
                   double const* __restrict c, double const* __restrict s, long half) {
  for (long k = 0; k < half; ++k) {
    double const tr = br[k] * c[k] - bi[k] * s[k], ti = br[k] * s[k] + bi[k] * c[k];
    br[k] = ar[k] - tr;
    bi[k] = ai[k] - ti;
    ar[k] += tr;
    ai[k] += ti;
  }
}

}  // namespace

void in_frequency(Points const& p, long half) {
  for (long a = 0, b = half; a < p.size; a += 2 * half, b += 2 * half)
    block_in_frequency(p.re + a, p.im + a, p.re + b, p.im + b, p.cosine + half, p.sine + half, half);
}

void in_time(Points const& p, long half) {
  for (long a = 0, b = half; a < p.size; a += 2 * half, b += 2 * half)
    block_in_time(p.re + a, p.im + a, p.re + b, p.im + b, p.cosine + half, p.sine + half, half);
}

}  // namespace sysid::fourier_stages
