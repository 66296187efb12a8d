// Whether a change of the inputs explains a record better all along it, or by chance in a few places.
#pragma once
#include <vector>

namespace sysid {

/// gains: of log likelihood, row by row; differences: squared differences of the two inputs, by which the gain of a row and the
/// variance of that gain rise. [N] each, along the record.
///
/// The record is divided into at most 16 successive parts, each with a sixteenth of the differences at least: where an input
/// changes rarely, a part reaches from one change to a later one. With gains g and differences w of the parts
///
///   b = sum g/sum w,   s^2 = sum (g - b w)^2/w /(parts - 1),   steady where b > t s/sqrt(sum w)
///
/// t: 0.3 % of Student's distribution with parts - 1 degrees of freedom. Never of fewer than 8 parts.
bool steady_gain(std::vector<double> const& gains, std::vector<double> const& differences);

}  // namespace sysid
