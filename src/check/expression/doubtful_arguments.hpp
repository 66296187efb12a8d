// Arguments of a distribution that are allowed, and probably not what was meant: widths of logarithms, angles in another unit.
#pragma once
#include <optional>
#include <string>

#include "core/text/diagnostic.hpp"
#include "distribution/distribution.hpp"
#include "model/quantity.hpp"
#include "syntax/ast.hpp"

namespace sysid {

struct WrittenArgument {
  ast::Expression const& tree;
  Spelling const& spelling;
  Span span;
};

/// Whether its arguments can be those of the logarithm.
bool is_of_logarithm(DistributionRow const& row);

/// `sd = 15` of a logarithm: more than any prior that is meant to be vague. width: where it is a number.
std::optional<Diagnostic> doubtful_width_of_logarithm(WrittenArgument const& given, std::optional<double> width,
                                                      std::string const& distribution);

/// `uniform(-180, 180)` of what is in [rad], `uniform(0, 2*pi)` of what is in [deg].
std::optional<Diagnostic> doubtful_angle(WrittenArgument const& given, Quantity const& variate);

}  // namespace sysid
