// Random draws from a distribution between bounds.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/text/diagnostic.hpp"
#include "distribution/distribution.hpp"

namespace sysid {
namespace {

[[noreturn]] void refuse(std::string code, std::string message, std::string help) {
  Diagnostic diagnostic;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.help = std::move(help);
  throw UserError(std::move(diagnostic));
}

// A draw that falls between the bounds is one of the truncated distribution, and so is the quantile's that follows when all these
// fall outside: the switch biases nothing, and where the mass is not small no probability is ever computed.
constexpr int tries = 32;

}  // namespace

double draw(DistributionRow const& row, std::span<double const> arguments, double lower, double upper, Stream& stream) {
  std::string const name(row.name);
  if (row.draw == nullptr)
    refuse("E2114", "`" + name + "` is improper and cannot be sampled", "use a proper prior, such as normal or log_uniform");
  if (std::string_view const reason = row.refuse(arguments); !reason.empty())
    refuse("E2112", "these arguments of `" + name + "` are impossible: " + std::string(reason), "correct the arguments");
  if (lower == -std::numeric_limits<double>::infinity() && upper == std::numeric_limits<double>::infinity())
    return row.draw(stream, arguments);

  if (lower < upper)
    for (int i = 0; i < tries; ++i) {
      double const x = row.draw(stream, arguments);
      if (lower <= x && x <= upper) return x;
    }

  // With constant arguments the expressions fold to numbers.
  Graph graph;
  Distribution use;
  use.row = &row;
  for (double const argument : arguments) use.arguments.push_back(graph.constant(argument));
  use.lower = graph.constant(lower);
  use.upper = graph.constant(upper);
  auto const number = [&](NodeId node) { return graph.constant_value(node).value(); };
  double const inside = number(mass(graph, use));
  if (!(lower < upper) || !(inside > 0))
    refuse("E2115", "`" + name + "` has no probability between its bounds", "widen `lower` and `upper`, or move the distribution");
  Support const bounds = support(graph, use);
  double const low = bounds.lower ? number(*bounds.lower) : -std::numeric_limits<double>::infinity();
  double const high = bounds.upper ? number(*bounds.upper) : std::numeric_limits<double>::infinity();
  // The nearer tail keeps the digits of small probabilities.
  double const to_low = bounds.lower ? number(row.cumulative(graph, *bounds.lower, use.arguments)) : 0;
  double const share = stream.uniform() * inside;
  double x;
  if (to_low > 0.5) {
    double const beyond = bounds.upper ? number(row.survival(graph, *bounds.upper, use.arguments)) : 0;
    x = row.quantile(beyond + share, Tail::upper, arguments);
  } else {
    x = row.quantile(to_low + share, Tail::lower, arguments);
  }
  return std::clamp(x, low, high);
}

}  // namespace sysid
