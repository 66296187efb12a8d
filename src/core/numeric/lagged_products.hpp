// Sums of products of a sequence with itself, shifted: what lagged_products_vector.cpp offers to diagnostics of chains.
#pragma once

namespace sysid {

/// Lags of one call.
inline constexpr int lags_at_once = 4;

/// out[l] += sum over i of x_i x_(i + first + l), l = 0 ... lags_at_once - 1; size: of x. The same bits on any machine.
void add_lagged_products(double const* x, long size, long first, double* out);

}  // namespace sysid
