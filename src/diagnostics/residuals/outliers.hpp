// Residuals that are far from all others.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace sysid {

inline constexpr double far_off_sds = 6;

/// Places of the residuals that lie more than 6 of their sds from zero, and 6 of the others': the sd is 1 where the noise is as
/// stated, and 1.4826 times the median of |residual| (Hampel 1974) where all are larger. Of normal noise one in 5e8 does. Nothing
/// where more than one alone and more than one in a hundred lie there, since then the noise or the model is to blame, nor among
/// fewer than 20. residuals: in units of the noise, NaN where there is none. In the order of their places.
std::vector<std::size_t> outliers(std::span<double const> residuals);

}  // namespace sysid
