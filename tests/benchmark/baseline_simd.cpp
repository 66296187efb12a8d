// The hand-written loops over lanes: the compiler's vectors of the widest registers, several side by side so that the latency of
// one operation is filled by others; compiled for the processor at hand, contraction allowed.
#include <immintrin.h>

#include <cstddef>

#include "baseline.hpp"

#ifdef __AVX512F__
extern "C" __m512d Sleef_finz_powd8_u10avx512f(__m512d, __m512d);
#else
extern "C" __m256d Sleef_finz_powd4_u10avx2(__m256d, __m256d);
#endif

namespace baseline {
namespace {

#ifdef __AVX512F__
constexpr int vector_lanes = 8;
#else
constexpr int vector_lanes = 4;
#endif
using Vector = double __attribute__((vector_size(vector_lanes * sizeof(double))));
using Bits = long long __attribute__((vector_size(vector_lanes * sizeof(double))));

Vector splat(double x) { return Vector{} + x; }
Vector load(double const* from) {
  Vector value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}
#ifdef __AVX512F__
Vector power(Vector x, Vector y) { return reinterpret_cast<Vector>(Sleef_finz_powd8_u10avx512f(__m512d(x), __m512d(y))); }
#else
Vector power(Vector x, Vector y) { return reinterpret_cast<Vector>(Sleef_finz_powd4_u10avx2(__m256d(x), __m256d(y))); }
#endif
Vector absolute(Vector x) { return reinterpret_cast<Vector>(reinterpret_cast<Bits>(x) & 0x7fffffffffffffffLL); }

/// `side` vectors, element by element.
template <int side>
struct Pack {
  Vector v[side];
};
template <int side, class F>
[[gnu::always_inline]] inline Pack<side> each(F const& f) {
  Pack<side> result;
#pragma GCC unroll 8
  for (int u = 0; u < side; ++u) result.v[u] = f(u);
  return result;
}

template <int side>
void duffing_block(Record const& record, double const* const* p, int first, double* out) {
  using P = Pack<side>;
  auto const row = [&](int r) { return each<side>([&](int u) { return load(p[r] + first + u * vector_lanes); }); };
  P const m = row(0), c = row(1), k = row(2), k3 = row(3), inverse_m = each<side>([&](int u) { return 1 / m.v[u]; });
  double const h = record.h;
  auto const acceleration = [&](P const& y, P const& v, double x) {
    return each<side>(
        [&](int u) { return (x - c.v[u] * v.v[u] - y.v[u] * (k.v[u] + k3.v[u] * y.v[u] * y.v[u])) * inverse_m.v[u]; });
  };
  auto const ahead = [&](P const& at, double step, P const& slope) {
    return each<side>([&](int u) { return at.v[u] + step * slope.v[u]; });
  };
  auto const mean = [&](P const& at, P const& a, P const& b, P const& c2, P const& d) {
    return each<side>([&](int u) { return at.v[u] + h / 6 * (a.v[u] + 2 * (b.v[u] + c2.v[u]) + d.v[u]); });
  };
  P y = each<side>([](int) { return splat(0); }), v = y, sum = y;
  for (std::size_t i = 0; i < record.measured.size(); ++i) {
    sum = each<side>([&](int u) {
      Vector const r = record.measured[i] - y.v[u];
      return sum.v[u] + r * r;
    });
    if (i + 1 == record.measured.size()) break;
    double const x0 = record.input[i], x2 = record.input[i + 1], x1 = 0.5 * (x0 + x2);
    P const a1 = acceleration(y, v, x0);
    P const y2 = ahead(y, 0.5 * h, v), v2 = ahead(v, 0.5 * h, a1), a2 = acceleration(y2, v2, x1);
    P const y3 = ahead(y, 0.5 * h, v2), v3 = ahead(v, 0.5 * h, a2), a3 = acceleration(y3, v3, x1);
    P const y4 = ahead(y, h, v3), v4 = ahead(v, h, a3), a4 = acceleration(y4, v4, x2);
    y = mean(y, v, v2, v3, v4);
    v = mean(v, a1, a2, a3, a4);
  }
  for (int u = 0; u < side; ++u) __builtin_memcpy(out + first + u * vector_lanes, &sum.v[u], sizeof sum.v[u]);
}

/// with_power: n is the sixth parameter, else 2.
template <int side, bool with_power>
void bouc_wen_block(Record const& record, double const* const* p, int first, double* out) {
  using P = Pack<side>;
  auto const row = [&](int r) { return each<side>([&](int u) { return load(p[r] + first + u * vector_lanes); }); };
  P const m = row(0), c = row(1), A = row(2), alpha = row(3), beta = row(4);
  P const inverse_m = each<side>([&](int u) { return 1 / m.v[u]; });
  double const h = record.h;
  auto const acceleration = [&](P const& v, P const& z, double x) {
    return each<side>([&](int u) { return (x - c.v[u] * v.v[u] - z.v[u]) * inverse_m.v[u]; });
  };
  P const n_less_one = with_power ? each<side>([&](int u) { return row(5).v[u] - 1; }) : m;
  auto const restoring = [&](P const& v, P const& z) {
    return each<side>([&](int u) {
      if constexpr (with_power) {
        Vector const size = absolute(z.v[u]), part = power(size, n_less_one.v[u]);
        return A.v[u] * v.v[u] - alpha.v[u] * absolute(v.v[u]) * part * z.v[u] - beta.v[u] * v.v[u] * part * size;
      }
      return v.v[u] * (A.v[u] - beta.v[u] * z.v[u] * z.v[u]) - alpha.v[u] * absolute(v.v[u]) * absolute(z.v[u]) * z.v[u];
    });
  };
  auto const ahead = [&](P const& at, double step, P const& slope) {
    return each<side>([&](int u) { return at.v[u] + step * slope.v[u]; });
  };
  auto const mean = [&](P const& at, P const& a, P const& b, P const& c2, P const& d) {
    return each<side>([&](int u) { return at.v[u] + h / 6 * (a.v[u] + 2 * (b.v[u] + c2.v[u]) + d.v[u]); });
  };
  P y = each<side>([](int) { return splat(0); }), v = y, z = y, sum = y;
  for (std::size_t i = 0; i < record.measured.size(); ++i) {
    sum = each<side>([&](int u) {
      Vector const r = record.measured[i] - y.v[u];
      return sum.v[u] + r * r;
    });
    if (i + 1 == record.measured.size()) break;
    double const x0 = record.input[i], x2 = record.input[i + 1], x1 = 0.5 * (x0 + x2);
    P const a1 = acceleration(v, z, x0), d1 = restoring(v, z);
    P const v2 = ahead(v, 0.5 * h, a1), z2 = ahead(z, 0.5 * h, d1), a2 = acceleration(v2, z2, x1), d2 = restoring(v2, z2);
    P const v3 = ahead(v, 0.5 * h, a2), z3 = ahead(z, 0.5 * h, d2), a3 = acceleration(v3, z3, x1), d3 = restoring(v3, z3);
    P const v4 = ahead(v, h, a3), z4 = ahead(z, h, d3), a4 = acceleration(v4, z4, x2), d4 = restoring(v4, z4);
    y = mean(y, v, v2, v3, v4);
    v = mean(v, a1, a2, a3, a4);
    z = mean(z, d1, d2, d3, d4);
  }
  for (int u = 0; u < side; ++u) __builtin_memcpy(out + first + u * vector_lanes, &sum.v[u], sizeof sum.v[u]);
}

}  // namespace

int simd_lanes() { return vector_lanes; }

void duffing_simd(Record const& record, double const* const* parameters, int lanes, double* sums) {
  int lane = 0;
  for (; lane + 4 * vector_lanes <= lanes; lane += 4 * vector_lanes) duffing_block<4>(record, parameters, lane, sums);
  for (; lane < lanes; lane += vector_lanes) duffing_block<1>(record, parameters, lane, sums);
}

void bouc_wen_simd(Record const& record, double const* const* parameters, int lanes, double* sums) {
  int lane = 0;
  for (; lane + 4 * vector_lanes <= lanes; lane += 4 * vector_lanes) bouc_wen_block<4, false>(record, parameters, lane, sums);
  for (; lane < lanes; lane += vector_lanes) bouc_wen_block<1, false>(record, parameters, lane, sums);
}

void bouc_wen_power_simd(Record const& record, double const* const* parameters, int lanes, double* sums) {
  int lane = 0;
  for (; lane + 4 * vector_lanes <= lanes; lane += 4 * vector_lanes) bouc_wen_block<4, true>(record, parameters, lane, sums);
  for (; lane < lanes; lane += vector_lanes) bouc_wen_block<1, true>(record, parameters, lane, sums);
}

}  // namespace baseline
