// How probable sets of terms are before the record.
#pragma once

namespace sysid {

/// Of one set of `taken` terms for an equation out of `offered`, log, up to a constant of `offered`: each term is in with the same
/// probability, by which an equation has `expected_terms` on average, however many are offered.
double log_structure_prior(int offered, int taken);

}  // namespace sysid
