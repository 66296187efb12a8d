// Lags side by side, so that each number is read once for all of them (compiled for the vectors of the processor, see
// CMakeLists.txt).
#include "core/numeric/lagged_products.hpp"

namespace sysid {
namespace {

constexpr long width = 8;  // two vectors, whose sums wait for one another half as long as those of one

typedef double Vector __attribute__((vector_size(32)));
typedef double Unaligned __attribute__((vector_size(32), aligned(8), may_alias));

Vector at(double const* x) { return *reinterpret_cast<Unaligned const*>(x); }

}  // namespace

void add_lagged_products(double const* x, long size, long first, double* out) {
  long const common = size - first - lags_at_once + 1;  // numbers that have a partner at every lag
  Vector low[lags_at_once] = {}, high[lags_at_once] = {};
  long i = 0;
  for (; i + width <= common; i += width) {
    Vector const a = at(x + i), b = at(x + i + width / 2);
    double const* const shifted = x + i + first;
    for (int l = 0; l < lags_at_once; ++l) {
      low[l] += a * at(shifted + l);
      high[l] += b * at(shifted + l + width / 2);
    }
  }
  for (int l = 0; l < lags_at_once; ++l) {
    Vector const both = low[l] + high[l];
    double sum = (both[0] + both[1]) + (both[2] + both[3]);
    for (long rest = i; rest + first + l < size; ++rest) sum += x[rest] * x[rest + first + l];
    out[l] += sum;
  }
}

}  // namespace sysid
