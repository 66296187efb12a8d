// Stages of Fourier transforms: what fourier_vector.cpp offers to fourier.cpp.
#pragma once

namespace sysid::fourier_stages {

/// Real and imaginary parts of `size` points, and the factors w of all stages: those of blocks of 2 `half` points stand at half ...
/// 2 half - 1.
struct Points {
  double *re, *im;
  long size;
  double const *cosine, *sine;
};

/// By decimation in frequency: a, b become a + b, (a - b) w.
void in_frequency(Points const& points, long half);
/// By decimation in time: a, b become a + b w, a - b w.
void in_time(Points const& points, long half);

}  // namespace sysid::fourier_stages
