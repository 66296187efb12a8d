// Formulas make their nodes in one order, whatever compiler has built them: their ids decide the order of operands, and so how sums
// and products of a program are rounded. Digests of all nodes, recorded once on x86-64 with GCC, which evaluates arguments from
// right to left; on AArch64 it does so from left to right, as clang does everywhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <string>
#include <vector>

#include "distribution/distribution.hpp"
#include "expression/function.hpp"
#include "function/table.hpp"

using namespace sysid;

namespace {

std::vector<NodeId> leaves(Graph& graph, std::size_t count) {
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(graph.leaf(LeafKind::parameter, static_cast<int>(i)));
  return result;
}

/// FNV-1a over what every node is and of which nodes it is made.
std::uint64_t digest(Graph const& graph) {
  std::uint64_t hash = 0xcbf29ce484222325;
  auto const add = [&](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3; };
  for (NodeId id = 0; id < graph.size(); ++id) {
    Node const& node = graph[id];
    for (auto const part : {static_cast<std::uint64_t>(node.operation), static_cast<std::uint64_t>(node.leaf_kind),
                            static_cast<std::uint64_t>(node.index), std::bit_cast<std::uint64_t>(node.value)})
      add(part);
    if (node.function != nullptr)
      for (char const letter : node.function->name) add(static_cast<unsigned char>(letter));
    for (NodeId const operand : {node.a, node.b, node.c}) add(operand);
  }
  return hash;
}

/// All that a distribution can be asked for, cut at both ends and not.
std::uint64_t nodes_of(DistributionRow const& row) {
  Graph graph;
  std::vector<NodeId> const at = leaves(graph, row.arguments.size() + 3);
  Distribution whole{&row, {at.begin(), at.end() - 3}, {}, {}};
  NodeId const x = at.back();
  for (ArgumentRow const& argument : row.arguments)
    for (Spelling const& spelling : argument.spellings)
      if (spelling.to_canonical != nullptr) spelling.to_canonical(graph, x, whole.arguments);
  log_density(graph, whole, x);
  if (row.centre != nullptr) row.centre(graph, whole.arguments);
  if (row.saturated != nullptr) row.saturated(graph, x, whole.arguments);
  std::vector<Distribution> uses{whole};
  if (row.cumulative != nullptr && row.survival != nullptr && row.proper) {
    uses.push_back({&row, whole.arguments, at[at.size() - 3], at[at.size() - 2]});
    log_density(graph, uses.back(), x);
  }
  for (Distribution const& use : uses) {
    Support const limits = support(graph, use);
    constrain(graph, limits, x);
    unconstrain(graph, limits, x);
  }
  return digest(graph);
}

std::uint64_t nodes_of(FunctionRow const& row) {
  Graph graph;
  std::vector<NodeId> const arguments = leaves(graph, static_cast<std::size_t>(std::clamp(row.maximum_arguments, 1, 3)));
  NodeId const value = row.build(graph, arguments);
  for (NodeId const argument : arguments) graph.differentiate(value, argument);
  return digest(graph);
}

/// Of powers, products, fused products and roots.
std::uint64_t nodes_of_derivatives() {
  Graph graph;
  std::vector<NodeId> const at = leaves(graph, 3);
  NodeId const x = at[0], first = graph.multiply(x, at[1]), second = graph.multiply(x, at[2]);
  NodeId const root = graph.unary(Operation::square_root, x), power = graph.power(first, second);
  NodeId const fused = graph.fused(root, power, x), size = graph.unary(Operation::absolute, x);
  graph.differentiate(graph.divide(fused, size), x);
  return digest(graph);
}

std::map<std::string, std::uint64_t> const recorded = {
    {"abs", 0x3f0ad78bae298d63},         {"acos", 0x1f326666229d2c05},
    {"asin", 0xc6051f57b940ae41},        {"atan", 0x50af48607af57303},
    {"atan2", 0x72a5dd93a00114b3},       {"beta", 0x00e33e09b5b8f28f},
    {"clamp", 0xe4b3fd35fb42de96},       {"cos", 0xbdc434739ea38dd7},
    {"cosh", 0x4bedfd71d7875b8f},        {"derivatives", 0x9b45e34387ae452d},
    {"erf", 0xaa0c43a8d35e660b},         {"erfc", 0x2d068485f7cbdb10},
    {"exp", 0xb802846e486de337},         {"expm1", 0x4cb02e804d77a452},
    {"exponential", 0xf100207380c60682}, {"flat", 0x94bb562c4275fe3f},
    {"floor", 0x33b005c8ae079586},       {"gamma", 0xaf8984794d97e2b7},
    {"half_cauchy", 0xe926909ad0483ae4}, {"half_normal", 0x21b1d2cf4f108c13},
    {"hypot", 0x454f6f48379c929e},       {"inverse_gamma", 0x0a29ffde3e783e5b},
    {"lgamma", 0xe9611f099d86c78b},      {"log", 0xbd7ffcdb2a4bbbc7},
    {"log10", 0x97e20e0d34279808},       {"log1p", 0x2f3c4e1691b50456},
    {"log_flat", 0x56fcf2e5de06818b},    {"log_normal", 0x161525f55d6e87c5},
    {"log_uniform", 0x0c637314a0ee3c1f}, {"max", 0xaaf2a29848107da5},
    {"min", 0xcceb6afbe28144e3},         {"negative_binomial", 0xcd205f5c71905deb},
    {"normal", 0xe80859d472700980},      {"normal_cdf", 0x366626572a73d330},
    {"piecewise", 0x6d8ebf67b0597ccd},   {"poisson", 0x64f8fb5b02e87d10},
    {"sign", 0xd8bc613c5d530d35},        {"sin", 0x182295a06ee5d45b},
    {"sinh", 0x3ea88b5c9b1091c1},        {"sqrt", 0xdd60774650d4703d},
    {"step", 0x91a5eab11acf1cbd},        {"student_t", 0x49ffc15ddd5daa2a},
    {"tan", 0x1eb3b05def197f5e},         {"tanh", 0x6d827493a2982a54},
    {"uniform", 0xd910ef090feae162},
};

}  // namespace

TEST_CASE("densities and functions make their nodes in one order") {
  std::map<std::string, std::uint64_t> found{{"derivatives", nodes_of_derivatives()}};
  for (DistributionRow const& row : distributions()) found[std::string(row.name)] = nodes_of(row);
  for (FunctionRow const& row : functions()) found[std::string(row.name)] = nodes_of(row);
  for (auto const& each : found) {
    CAPTURE(each.first);
    CAPTURE(each.second);
    auto const before = recorded.find(each.first);
    CHECK((before != recorded.end() && before->second == each.second));
  }
  CHECK(found.size() == recorded.size());
}
