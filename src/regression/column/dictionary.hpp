// A discovery problem in numbers: which terms may stand in which equation, and what the measured channels are. No text of the
// user's file passes, no units: every number is coherent SI.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "expression/graph.hpp"

namespace sysid::regression {

/// What a leaf of the dictionary's graph stands for; any leaf may be chosen.
struct Symbol {
  enum class Kind { state, input, time };

  NodeId leaf = 0;
  Kind kind = Kind::state;
  int index = 0;  // of the state, or of the experiment's input
  int order = 0;  // derivative order: y is 0, y' is 1; of inputs 0 or 1
  int lag = 0;    // in discrete time, samples back
};

/// A candidate: the coefficient before `expression` is looked for.
struct Term {
  std::string name;       // as messages call it: "abs(y)*y'"
  NodeId expression = 0;  // over the symbols' leaves and constants
  bool always = false;    // part of every support (a known term whose coefficient is free)
};

/// known = sum_j coefficient_j term_j.
struct Equation {
  std::string name;  // as messages call it: "y", "prey"
  NodeId known = 0;  // without free coefficients
  std::vector<Term> terms = {};
};

/// Index c is column c of Experiment::measured; several channels may measure one state at different orders.
struct Channel {
  std::string name;
  int state = 0;
  int order = 0;                        // 2: an acceleration
  std::optional<double> noise_sd = {};  // estimated from the record where absent
};

struct Dictionary {
  Graph graph;
  std::vector<Symbol> symbols;
  std::vector<std::string> states;  // names
  std::vector<Channel> channels;
  std::vector<Equation> equations;
  bool discrete = false;  // difference equations: each gives a state at the present sample from samples before, which are symbols
};

/// A target that is affine in its free coefficients, taken apart: `target = sum_j w_j term_j` with target = known + sum_i a_i f_i
/// is known = sum_i a_i (-f_i) + sum_j w_j term_j.
struct SplitTarget {
  NodeId known = 0;
  std::vector<Term> free;  // -f_i, always in; names as given
};

/// coefficients: name and leaf of each free coefficient in `target`. Nothing when the target is not affine in them, or when a
/// coefficient drops out of it.
std::optional<SplitTarget> split_target(Graph& graph, NodeId target, std::span<std::pair<std::string, NodeId> const> coefficients);

}  // namespace sysid::regression
