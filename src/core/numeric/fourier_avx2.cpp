// Stages of Fourier transforms (compiled for AVX2, see CMakeLists.txt). Sums and products are those of the formulas, in their
// order: no two are fused.
#include <immintrin.h>

#include "core/numeric/fourier_stages.hpp"

namespace sysid::fourier_stages {
namespace {

/// Four points.
struct Four {
  __m256d re, im;
};

Four load(double const* re, double const* im) { return {_mm256_loadu_pd(re), _mm256_loadu_pd(im)}; }

void store(Four x, double* re, double* im) {
  _mm256_storeu_pd(re, x.re);
  _mm256_storeu_pd(im, x.im);
}

Four sum(Four a, Four b) { return {_mm256_add_pd(a.re, b.re), _mm256_add_pd(a.im, b.im)}; }

Four difference(Four a, Four b) { return {_mm256_sub_pd(a.re, b.re), _mm256_sub_pd(a.im, b.im)}; }

Four product(Four a, Four w) {
  return {_mm256_sub_pd(_mm256_mul_pd(a.re, w.re), _mm256_mul_pd(a.im, w.im)),
          _mm256_add_pd(_mm256_mul_pd(a.re, w.im), _mm256_mul_pd(a.im, w.re))};
}

void butterfly_in_frequency(Four& a, Four& b, Four w) {
  Four const apart = difference(a, b);
  a = sum(a, b);
  b = product(apart, w);
}

void butterfly_in_time(Four& a, Four& b, Four w) {
  Four const turned = product(b, w);
  b = difference(a, turned);
  a = sum(a, turned);
}

using Butterfly = void (*)(Four&, Four&, Four);

/// Blocks of 2 or 4 points: two vectors hold the firsts and seconds of four butterflies once their halves, or every other number,
/// have changed places.
template <Butterfly butterfly, int half>
void short_stage(Points const& p) {
  Four const w = half == 1 ? Four{_mm256_set1_pd(p.cosine[1]), _mm256_set1_pd(p.sine[1])}
                           : Four{_mm256_setr_pd(p.cosine[2], p.cosine[3], p.cosine[2], p.cosine[3]),
                                  _mm256_setr_pd(p.sine[2], p.sine[3], p.sine[2], p.sine[3])};
  auto const low = [](__m256d x, __m256d y) { return half == 1 ? _mm256_unpacklo_pd(x, y) : _mm256_permute2f128_pd(x, y, 0x20); };
  auto const high = [](__m256d x, __m256d y) { return half == 1 ? _mm256_unpackhi_pd(x, y) : _mm256_permute2f128_pd(x, y, 0x31); };
  for (long i = 0; i < p.size; i += 8) {
    Four const x = load(p.re + i, p.im + i), y = load(p.re + i + 4, p.im + i + 4);
    Four a{low(x.re, y.re), low(x.im, y.im)}, b{high(x.re, y.re), high(x.im, y.im)};
    butterfly(a, b, w);
    store({low(a.re, b.re), low(a.im, b.im)}, p.re + i, p.im + i);
    store({high(a.re, b.re), high(a.im, b.im)}, p.re + i + 4, p.im + i + 4);
  }
}

template <Butterfly butterfly>
void stage(Points const& p, long half) {
  if (half == 1) return short_stage<butterfly, 1>(p);
  if (half == 2) return short_stage<butterfly, 2>(p);
  for (long start = 0; start < p.size; start += 2 * half)
    for (long k = 0; k < half; k += 4) {
      double *const re = p.re + start + k, *const im = p.im + start + k;
      Four a = load(re, im), b = load(re + half, im + half);
      butterfly(a, b, load(p.cosine + half + k, p.sine + half + k));
      store(a, re, im);
      store(b, re + half, im + half);
    }
}

}  // namespace

void in_frequency(Points const& points, long half) { stage<butterfly_in_frequency>(points, half); }
void in_time(Points const& points, long half) { stage<butterfly_in_time>(points, half); }

void two_in_frequency(Points const& p, long half) {
  long const quarter = half / 2;
  for (long start = 0; start < p.size; start += 2 * half)
    for (long k = 0; k < quarter; k += 4) {
      double *const re = p.re + start + k, *const im = p.im + start + k;
      Four x[4];
      for (long i = 0; i < 4; ++i) x[i] = load(re + i * quarter, im + i * quarter);
      butterfly_in_frequency(x[0], x[2], load(p.cosine + half + k, p.sine + half + k));
      butterfly_in_frequency(x[1], x[3], load(p.cosine + half + quarter + k, p.sine + half + quarter + k));
      Four const w = load(p.cosine + quarter + k, p.sine + quarter + k);
      butterfly_in_frequency(x[0], x[1], w);
      butterfly_in_frequency(x[2], x[3], w);
      for (long i = 0; i < 4; ++i) store(x[i], re + i * quarter, im + i * quarter);
    }
}

void two_in_time(Points const& p, long half) {
  for (long start = 0; start < p.size; start += 4 * half)
    for (long k = 0; k < half; k += 4) {
      double *const re = p.re + start + k, *const im = p.im + start + k;
      Four x[4];
      for (long i = 0; i < 4; ++i) x[i] = load(re + i * half, im + i * half);
      Four const w = load(p.cosine + half + k, p.sine + half + k);
      butterfly_in_time(x[0], x[1], w);
      butterfly_in_time(x[2], x[3], w);
      butterfly_in_time(x[0], x[2], load(p.cosine + 2 * half + k, p.sine + 2 * half + k));
      butterfly_in_time(x[1], x[3], load(p.cosine + 3 * half + k, p.sine + 3 * half + k));
      for (long i = 0; i < 4; ++i) store(x[i], re + i * half, im + i * half);
    }
}

}  // namespace sysid::fourier_stages
