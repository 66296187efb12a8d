// Stages of Fourier transforms over vectors of 4 numbers: what fourier_avx2.cpp offers to fourier.cpp.
#pragma once

namespace sysid::fourier_stages {

/// Real and imaginary parts of `size` points, and the factors of all stages: those of blocks of 2 `half` points stand at half ...
/// 2 half - 1.
struct Points {
  double *re, *im;
  long size;
  double const *cosine, *sine;
};

/// By decimation in frequency: a, b become a + b, (a - b) w. One stage, for half = 1, 2 or a multiple of 4; or, for a half that is
/// a multiple of 8, this one and the next, of blocks half as long, in one pass over the points.
void in_frequency(Points const& points, long half);
void two_in_frequency(Points const& points, long half);

/// By decimation in time: a, b become a + b w, a - b w. One stage; or, for a multiple of 4, this one and the next, of blocks twice
/// as long.
void in_time(Points const& points, long half);
void two_in_time(Points const& points, long half);

}  // namespace sysid::fourier_stages
