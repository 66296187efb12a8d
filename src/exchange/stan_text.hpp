// Expressions of a model in Stan's language. Stan has a function of the same name for nearly all of ours.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// A number as a real of Stan: 2 as `2.0`, since 1/2 of whole numbers is 0 there.
std::string stan_real(double value);

struct StanExpressions {
  std::string declarations;        // of what is needed several times, one line each, for the body of a function
  std::vector<std::string> texts;  // per root
};

/// What stands for a leaf.
using StanLeaves = std::function<std::string(NodeId)>;

/// A function of ours that Stan does not have, where the roots need one.
std::optional<std::string> lacking_in_stan(Graph const& graph, std::span<NodeId const> roots);

/// Of roots for which nothing is lacking.
StanExpressions stan_expressions(Graph const& graph, std::span<NodeId const> roots, StanLeaves const& leaf_text);

/// Functions that the expressions call beside those of Stan.
std::string_view stan_own_functions();

}  // namespace sysid
