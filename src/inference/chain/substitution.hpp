// A step of forward substitution over lanes: what substitution_vector.cpp offers to mixtures of normal distributions.
#pragma once

namespace sysid::metropolis {

/// rest[w] -= sum over j of factors[j] z[j stride + w], in the order of j, of `count` rows and so many lanes.
void subtract_rows(double* rest, double const* z, long stride, double const* factors, long count, long lanes);

}  // namespace sysid::metropolis
