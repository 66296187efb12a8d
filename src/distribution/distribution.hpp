// A probability distribution as a row of data, and one use of it in a model. Densities are expressions, so the same text serves
// priors, noise, truncation and every executor. One file and one row (distribution/table.cpp) adds another.
#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/numeric/random.hpp"
#include "expression/graph.hpp"

namespace sysid {

/// One way to write an argument: `sd`, `variance` and `precision` are spellings of one argument.
struct Spelling {
  std::string_view name;
  int unit_power;  // the argument's unit is u^power, u the unit of the variate: mean 1, variance 2, precision -2, rate -1, shape 0
  /// The canonical argument from this spelling; nullptr: it is canonical.
  NodeId (*to_canonical)(Graph&, NodeId given, std::span<NodeId const> canonical_before);
  bool logarithm = false;  // of the number that the canonical argument is in the unit of the variate
};

/// Arguments with one spelling may be positional; an argument with several spellings must be named, unless it says otherwise.
struct ArgumentRow {
  std::span<Spelling const> spellings;  // the canonical one first
  /// Default when left out, as a number in the unit of the variate; NaN: it must be given.
  double fallback;
  bool by_position = false;  // is the first of its spellings then
};

/// Which side of a quantile a probability is counted on: in its own tail it keeps all its digits.
enum class Tail { lower, upper };

struct NoiseMoments {
  double mean = 0, variance = 0;
};

/// A row names what it has; what it leaves out it has not.
struct DistributionRow {
  std::string_view name;
  std::span<ArgumentRow const> arguments;
  bool noise = false;  // may stand after `observe CHANNEL ~`
  /// Has a finite integral; `flat` has not and cannot be drawn from: bounds restrict it and nothing is normalised.
  bool proper = true;
  bool logarithmic = false;    // the sampler's coordinate is logarithmic between finite bounds (log_uniform)
  bool dimensionless = false;  // the variate is a pure number (beta)
  bool gaussian = false;       // closed under sums and conditioning: what processes and linear coefficients need
  /// log p(x | arguments), all constants kept; x inside the support.
  NodeId (*log_density)(Graph&, NodeId x, std::span<NodeId const> arguments);
  /// P(X <= x); nullptr: cannot be truncated.
  NodeId (*cumulative)(Graph&, NodeId x, std::span<NodeId const> arguments) = nullptr;
  /// P(X > x), accurate where it is small; nullptr only when improper or discrete.
  NodeId (*survival)(Graph&, NodeId x, std::span<NodeId const> arguments) = nullptr;
  /// Natural bounds of the support; nullptr: infinite on that side.
  NodeId (*lower)(Graph&, std::span<NodeId const> arguments) = nullptr;
  NodeId (*upper)(Graph&, std::span<NodeId const> arguments) = nullptr;
  /// The x at which a noise density is largest as a function of its location: where residuals vanish. nullptr unless noise.
  NodeId (*centre)(Graph&, std::span<NodeId const> arguments) = nullptr;
  /// The largest log density that any location gives to x, all else equal: log p(x | location = x, ...). Untruncated,
  /// saturated - log_density is never negative: half the squared deviance residual of x. nullptr unless noise.
  NodeId (*saturated)(Graph&, NodeId x, std::span<NodeId const> arguments) = nullptr;
  /// One draw, untruncated; nullptr when improper.
  double (*draw)(Stream&, std::span<double const> arguments) = nullptr;
  /// Inverse of `cumulative` (tail lower) or `survival` (upper), for draws from narrow truncations; nullptr only when improper or
  /// discrete.
  double (*quantile)(double probability, Tail tail, std::span<double const> arguments) = nullptr;
  /// From the arguments those of a distribution `factor` times as wide: about the same middle (of the logarithm, where the
  /// distribution is one of that), or from the same end at zero. nullptr: it has no width.
  void (*widen)(double factor, std::span<double> arguments) = nullptr;
  /// Whether numeric arguments are admissible (sd > 0, lower < upper); returns the reason when not, else empty.
  std::string_view (*refuse)(std::span<double const> arguments);
  std::string_view summary;
  /// The variate is a count: `log_density` is the logarithm of a probability, no unit scales it, and it is noise only. Neither
  /// truncated nor a prior, so cumulative, survival and quantile are nullptr.
  bool discrete = false;
  /// Of a discrete noise, for Pearson's residual (y - centre)/sqrt(variance) and its fourth moment; nullptr for the others.
  double (*variance)(std::span<double const> arguments) = nullptr;
  double (*excess_kurtosis)(std::span<double const> arguments) = nullptr;
  /// Of the variate, untruncated; the variance may be infinite. nullptr unless noise.
  NoiseMoments (*moments)(std::span<double const> arguments) = nullptr;
};

/// Of a noise: whether it multiplies what is predicted, as log-normal noise does, so that it has one size by logarithms.
inline bool multiplies(DistributionRow const& noise) { return noise.lower != nullptr && !noise.discrete; }

std::span<DistributionRow const> distributions();
DistributionRow const* find_distribution(std::string_view name);

/// A distribution as used: arguments are expressions, in canonical form and order; bounds are the user's truncation.
struct Distribution {
  DistributionRow const* row = nullptr;
  std::vector<NodeId> arguments;
  std::optional<NodeId> lower, upper;
};

/// The probability that the untruncated distribution gives to what the bounds leave of its support; 1 without bounds or when
/// improper. Accurate to rounding in either tail; of an interval narrow against the distribution, to rounding over mass.
NodeId mass(Graph& graph, Distribution const& use);

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
/// No overflow and no cancellation for |u| up to 700; strictly inside the bounds unless closer to a bound than its rounding.
Coordinate constrain(Graph& graph, Support const& support, NodeId u);
/// The inverse of `constrain`.
NodeId unconstrain(Graph& graph, Support const& support, NodeId x);

/// One draw inside [lower, upper] (infinities allowed): by rejection, and by the quantile when all of some tries fell outside.
/// Throws UserError: E2112 inadmissible arguments, E2114 improper distribution, E2115 no mass between the bounds.
double draw(DistributionRow const& row, std::span<double const> arguments, double lower, double upper, Stream& stream);

}  // namespace sysid
