// A probability distribution as a row of data, and one use of it in a model. Densities are expressions, so the same text serves priors,
// noise, truncation and every executor. One file and one row (distribution/table.cpp) adds another.
#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "expression/graph.hpp"

namespace sysid {

/// One way to write an argument: `sd`, `variance` and `precision` are spellings of one argument.
struct Spelling {
  std::string_view name;
  int unit_power;  // the argument's unit is u^power, u the unit of the variate: mean 1, variance 2, precision -2, rate -1, shape 0
  /// The canonical argument from this spelling; nullptr: it is canonical.
  NodeId (*to_canonical)(Graph&, NodeId given, std::span<NodeId const> canonical_before);
};

/// Arguments with one spelling may be positional; an argument with several spellings must be named.
struct ArgumentRow {
  std::span<Spelling const> spellings;  // the canonical one first
  /// Default when left out, as a number in the unit of the variate; NaN: it must be given.
  double fallback;
};

struct DistributionRow {
  std::string_view name;
  std::span<ArgumentRow const> arguments;
  bool noise;         // may stand after `observe CHANNEL ~`
  bool proper;        // has a finite integral; `flat` has not and cannot be drawn from
  bool logarithmic;   // the sampler's coordinate is logarithmic between finite bounds (log_uniform)
  /// log p(x | arguments), all constants kept; x inside the support.
  NodeId (*log_density)(Graph&, NodeId x, std::span<NodeId const> arguments);
  /// P(X <= x); nullptr: cannot be truncated.
  NodeId (*cumulative)(Graph&, NodeId x, std::span<NodeId const> arguments);
  /// Natural bounds of the support; nullptr: infinite on that side.
  NodeId (*lower)(Graph&, std::span<NodeId const> arguments);
  NodeId (*upper)(Graph&, std::span<NodeId const> arguments);
  /// The value of x at which a noise density is largest as a function of its location: where residuals vanish. nullptr unless noise.
  NodeId (*centre)(Graph&, std::span<NodeId const> arguments);
  /// One draw, untruncated; nullptr when improper.
  double (*draw)(Stream&, std::span<double const> arguments);
  /// Inverse of `cumulative`, for draws from a narrow truncation; nullptr: rejection only.
  double (*quantile)(double probability, std::span<double const> arguments);
  /// Whether numeric arguments are admissible (sd > 0, lower < upper); returns the reason when not, else empty.
  std::string_view (*refuse)(std::span<double const> arguments);
  std::string_view summary;
};

std::span<DistributionRow const> distributions();
DistributionRow const* find_distribution(std::string_view name);

/// A distribution as used: arguments are expressions, in canonical form and order; bounds are the user's truncation.
struct Distribution {
  DistributionRow const* row = nullptr;
  std::vector<NodeId> arguments;
  std::optional<NodeId> lower, upper;
};

/// log density of the (truncated, normalised) distribution at x, which lies inside the support.
NodeId log_density(Graph& graph, Distribution const& use, NodeId x);

/// Bounds after truncation; absent means infinite.
struct Support {
  std::optional<NodeId> lower, upper;
  bool logarithmic = false;
};
Support support(Graph& graph, Distribution const& use);

/// The declared value as a function of the sampler's coordinate u on the whole line, and log |dx/du|.
///   none: x = u;  lower: x = a + e^u;  upper: x = b - e^u;  both: x = a + (b - a)/(1 + e^-u), or the same between log a and log b.
struct Coordinate {
  NodeId value;
  NodeId log_jacobian;
};
Coordinate constrain(Graph& graph, Support const& support, NodeId u);
/// The inverse of `constrain`.
NodeId unconstrain(Graph& graph, Support const& support, NodeId x);

/// One draw inside [lower, upper] (infinities allowed): by rejection while the mass is not small, else by the quantile. Throws UserError
/// (E2) when the distribution is improper, the arguments are inadmissible or the interval holds no mass.
double draw(DistributionRow const& row, std::span<double const> arguments, double lower, double upper, Stream& stream);

}  // namespace sysid
