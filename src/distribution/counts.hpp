// What the distributions of counts share: terms that stay defined at zero, and exact variates.
#pragma once
#include "distribution/rows.hpp"

namespace sysid {

/// count*log(mean), the limit where the mean is 0: 0 for a count of 0, else -infinity. NaN for a negative mean. Nothing in it is
/// infinite unless the whole is, so that a failed solve is traced to the mean.
inline Term count_times_log(Term count, Term mean) {
  Graph& graph = *count.graph;
  auto const is_zero = [&](Term x) { return graph.binary(Operation::equal, x.id, graph.constant(0)); };
  NodeId const no_mean = is_zero(mean), no_count = is_zero(count);
  Term const both(graph, graph.binary(Operation::conjunction, no_count, no_mean));
  return count * log(select(both, Term(graph, 1.0), mean));
}

/// Means beyond this leave no whole numbers between neighbouring doubles to count with.
constexpr double largest_mean = 1e15;

/// A Poisson variate, 0 <= mean <= largest_mean.
double poisson_variate(double mean, Stream& stream);

}  // namespace sysid
