// Expressions of a model in Stan's language. Stan has a function of the same name for nearly all of ours.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// A number as a real of Stan: 2 as `2.0`, since 1/2 of whole numbers is 0 there.
std::string stan_real(double value);

/// A name as Stan may call it: letters, digits and underscores, no word of Stan or C++; `taken` gets it.
std::string stan_identifier(std::string const& name, std::vector<std::string>& taken);

struct StanExpressions {
  std::string declarations;        // of what is needed several times, one line each, for the body of a function
  std::vector<std::string> texts;  // per root
};

/// leaf_text: what stands for a leaf. UserError names a function that Stan does not have.
StanExpressions stan_expressions(Graph const& graph, std::span<NodeId const> roots,
                                 std::function<std::string(NodeId)> const& leaf_text);

/// Functions that the expressions call beside those of Stan.
std::string_view stan_functions();

}  // namespace sysid
