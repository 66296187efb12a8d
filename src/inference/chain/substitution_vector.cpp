// Lanes in vectors, each of which stays in its register for all rows (compiled for the vectors of the processor, see
// CMakeLists.txt).
#include "inference/chain/substitution.hpp"

namespace sysid::metropolis {
namespace {

typedef double Vector __attribute__((vector_size(32)));
typedef double Unaligned __attribute__((vector_size(32), aligned(8), may_alias));

constexpr long side_by_side = 4, width = 4 * side_by_side;  // vectors, lanes

Vector at(double const* x) { return *reinterpret_cast<Unaligned const*>(x); }

}  // namespace

void subtract_rows(double* rest, double const* z, long stride, double const* factors, long count, long lanes) {
  long w = 0;
  for (; w + width <= lanes; w += width) {
    Vector sum[side_by_side];
    for (long v = 0; v < side_by_side; ++v) sum[v] = at(rest + w + 4 * v);
    for (long j = 0; j < count; ++j)
      for (long v = 0; v < side_by_side; ++v) sum[v] -= factors[j] * at(z + j * stride + w + 4 * v);
    for (long v = 0; v < side_by_side; ++v) *reinterpret_cast<Unaligned*>(rest + w + 4 * v) = sum[v];
  }
  for (; w + 4 <= lanes; w += 4) {
    Vector sum = at(rest + w);
    for (long j = 0; j < count; ++j) sum -= factors[j] * at(z + j * stride + w);
    *reinterpret_cast<Unaligned*>(rest + w) = sum;
  }
  for (; w < lanes; ++w)
    for (long j = 0; j < count; ++j) rest[w] -= factors[j] * z[j * stride + w];
}

}  // namespace sysid::metropolis
