// One dictionary on its way from the tree to a discovery problem in numbers: the passes and what they share. `run` in
// dictionary.cpp puts them in order; each group is defined in a file of its own, dictionary_*.cpp.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "check/checked/checked.hpp"
#include "check/dictionary/term_writer.hpp"
#include "check/expression/scope.hpp"
#include "core/text/diagnostic.hpp"
#include "expression/factors.hpp"
#include "regression/column/signals.hpp"
#include "syntax/ast.hpp"

namespace sysid {

class DictionaryChecker {
 public:
  DictionaryChecker(ast::Dictionary const& tree, std::vector<ast::FunctionDefinition const*> const& functions,
                    Diagnostics& diagnostics);

  /// The problem, or nothing when an error was reported.
  std::optional<CheckedDictionary> run();

 private:
  struct StateInfo {
    std::optional<Unit> unit;
    Span span;
    int most_primes = 0;
    bool measured = false;
  };
  struct ParameterInfo {
    ast::DictionaryParameter const* tree = nullptr;
    std::optional<Unit> unit;
    std::optional<double> value;  // coherent SI
    bool used = false;
    bool inner = false;  // inside terms, with a prior
  };
  struct Target {
    ast::Expression const* tree;
    Typed value;
  };
  struct AllowedUnit {
    Unit unit;
    Span span;
    bool matched = false;
  };
  /// A term on its way, before it is known in which equations it stands.
  struct Candidate {
    WrittenTerm written;
    NodeId node = 0;
    std::optional<Unit> unit;
    Factors factors;
  };

  bool failed() const { return diagnostics_.has_errors(before_); }

  template <class Statement, class Visit>
  void each(Visit const& visit) const {
    for (ast::DictionaryStatement const& statement : tree_.statements)
      if (auto const* one = std::get_if<Statement>(&statement)) visit(*one);
  }
  template <class Visit>
  void each_item(ast::DictionaryListKind kind, Visit const& visit) const {
    each<ast::DictionaryList>([&](ast::DictionaryList const& list) {
      if (list.kind == kind)
        for (ast::Expression const& item : list.items)
          if (!refuse_list(kind, item)) visit(item);
    });
  }
  static bool is_parameter(Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter; }

  /// `terms = (y, y')`: whether it is one.
  bool refuse_list(ast::DictionaryListKind kind, ast::Expression const& item) const;

  // --- dictionary_declarations.cpp
  void declare();
  void declare_input(ast::Declared const& input);
  void declare_state(ast::DictionaryState const& state);
  StateInfo* find_state(std::string const& name);
  int index_of(std::string const& name) const;
  void require_channels();
  void refuse_index(ast::Reference const& reference);
  void find_orders();
  // Every derivative that is mentioned is a leaf of its own; none is solved for.
  void lay_out();
  void lay_out_lags();
  void definitions();
  void values();
  std::optional<InnerParameter> inner_parameter(ParameterInfo const& parameter, int index);

  // --- dictionary_terms.cpp
  void targets();
  void terms();
  void exclude();
  std::optional<Candidate> candidate(WrittenTerm written);
  // Whether each parameter inside does more than scale the term.
  bool bends(Candidate const& made);
  /// "K [kg]".
  static std::string declared_text(ParameterInfo const& parameter);
  bool depends_on(NodeId root, NodeId leaf) const;
  // Numbers for the parameters that have one.
  NodeId with_values(NodeId root);

  // --- dictionary_equations.cpp
  void equations();
  void equation(int index);
  ParameterInfo& parameter_of(std::string const& name);
  // The term in this equation, unless its unit or the target forbids it.
  void add(int index, Candidate const& term, regression::SplitTarget const& split, DictionaryEquation& equation,
           regression::Equation& numbers, std::vector<Candidate const*>& kept);
  // Whether it is the target itself, which would explain itself: refused, or left out of this equation.
  bool is_target(int index, Candidate const& term, regression::SplitTarget const& split);
  void leave_out(int index, Candidate const& term, Unit const& unit);

  // Numbers for the parameters inside terms, the medians of their priors.
  void close_terms();

  // --- dictionary_discrete.cpp
  // In discrete time: each equation gives one state at the present sample, from what is known by then.
  void require_difference_equations();

  // --- dictionary_unused.cpp
  void coefficient_units_used();
  void parameters_used();
  void inputs_used();

  ast::Dictionary const& tree_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  CheckedDictionary out_;
  Scope scope_;
  TermWriter writer_;
  std::vector<std::pair<std::string, StateInfo>> states_;
  std::vector<ParameterInfo> parameters_;
  std::set<std::string> free_;         // parameters that are looked for
  std::set<std::string> primed_;       // names that carry primes somewhere
  std::map<std::string, Span> bound_;  // channels
  std::vector<AllowedUnit> allowed_;
  std::vector<Target> targets_;
  std::vector<Candidate> terms_;
  std::set<std::string> possible_;  // units that coefficients would have
};

}  // namespace sysid
