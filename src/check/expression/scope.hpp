// The names of one model and how an expression that uses them becomes nodes of the model's graph.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "check/expression/lags.hpp"
#include "check/units/quantity.hpp"
#include "check/units/unit_check.hpp"
#include "check/units/units.hpp"
#include "core/text/diagnostic.hpp"
#include "model/model.hpp"
#include "syntax/ast.hpp"

namespace sysid {

struct ProcessArguments;  // check/process/process_covariance.hpp

struct StateSymbol {
  int first = 0;    // leaf state(first) is y, first + 1 is y', ...
  int order = 0;    // y^(order) is solved for
  int unknown = 0;  // leaf unknown(unknown) is the highest derivative
};
struct InputSymbol {
  int index = 0;
};
/// A disturbance: the state that it is, or where that is -1 the leaf of its white noise.
struct DisturbanceSymbol {
  int index = 0;
  int state = -1;
};
struct ParameterSymbol {
  int index = 0;
};
struct TimeSymbol {};
/// constant, let or derive: an expression under a name, turned into a node when first used.
struct DefinitionSymbol {
  ast::Definition const* definition = nullptr;
};

struct Symbol {
  std::variant<StateSymbol, InputSymbol, DisturbanceSymbol, ParameterSymbol, TimeSymbol, DefinitionSymbol> what;
  std::optional<Unit> unit;
  Span span;
};

/// Order-free: definitions are resolved on use, loops are reported with the loop written out. One Scope per model.
class Scope {
 public:
  Scope(Graph& graph, Diagnostics& diagnostics, std::vector<ast::FunctionDefinition const*> shared_functions);

  /// The same names, reporting elsewhere: for a look that may fail without being the user's mistake.
  Scope with(Diagnostics& diagnostics) const { return Scope(*this, diagnostics); }

  UnitCheck const& units() const { return units_; }
  UnitCheck& units() { return units_; }

  /// False, with a diagnostic, when the name is taken.
  bool declare(ast::Name const& name, Symbol symbol);
  bool define_function(ast::FunctionDefinition const& function);
  bool define_process(ast::ProcessDefinition const& process);
  Symbol const* find(std::string const& name) const;
  Symbol* find(std::string const& name);
  /// A function of the user's; null for built-in ones.
  ast::FunctionDefinition const* find_function_definition(std::string const& name) const;

  /// What stands between brackets.
  std::optional<Unit> unit(std::optional<ast::UnitExpression> const& expression) { return check_unit(expression, diagnostics_); }

  /// Nothing when a diagnostic was added that leaves no value; of unknown unit after one that does.
  std::optional<Typed> expression(ast::Expression const& expression);
  /// An expression that must have the unit declared at `place`; absent: any.
  std::optional<Typed> expression_in(std::optional<Unit> const& unit, Span place, ast::Expression const& expression,
                                     Occasion const& occasion);
  /// Both sides of an equation, with literals adapted: their addends all have one unit. One is `wrong` where they have not.
  std::optional<std::pair<Typed, Typed>> equation(ast::Equation const& equation);
  /// A definition's value in its declared unit.
  std::optional<Typed> definition(ast::Definition const& definition);

  /// What stayed without a unit where one was needed, in the order of the text.
  std::vector<Unchecked> unchecked() const;
  /// A declared Gaussian process: leaf process(i) where it stands i-th. use: once it has been applied, by `call`.
  struct ProcessName {
    ast::ProcessDefinition const* definition;
    std::optional<Process> use;
    Span call;
    std::vector<int> coefficients{};       // of one that is a finite sum: parameters of the model
    std::optional<Expansion> expansion{};  // in place of `use`
  };
  std::vector<ProcessName>& processes() { return processes_; }
  /// What a declaration says of a process whose inputs are laid out: kernels, hyper-parameters in SI, the unit of its values. Names
  /// are the model's, wherever the process is applied. columns: of each declared input those among process.inputs; units: of each
  /// of these, where it is known, without a zero point. Nothing after a diagnostic.
  std::optional<ProcessArguments> process_declaration(ast::ProcessDefinition const& definition,
                                                      std::vector<std::vector<int>> const& columns,
                                                      std::vector<std::optional<Unit>> const& units, Process& process);

  /// What is known of samples and channels; the model's checker fills it.
  SampleNames& samples() { return samples_; }

  Graph& graph() { return graph_; }
  Diagnostics& diagnostics() { return diagnostics_; }
  std::vector<std::string> names() const;
  /// Of these the states and inputs.
  std::vector<std::string> moving_names() const;

 private:
  Scope(Scope const& other, Diagnostics& diagnostics)
      : graph_(other.graph_),
        diagnostics_(diagnostics),
        symbols_(other.symbols_),
        functions_(other.functions_),
        processes_(other.processes_),
        units_(other.units_, diagnostics),
        samples_(other.samples_) {}
  void open_names(ast::Expression const& tree, std::set<std::string>& names, std::set<std::string>& seen) const;
  std::optional<Unit> unit_of(ast::Definition const& definition) const;
  std::optional<Typed> reference(ast::Reference const& reference);
  /// The value of a sum; its addends are appended to `terms`. Anything else is a sum of one.
  std::optional<Typed> sum(ast::Expression const& tree, std::vector<UnitOperand>& terms, int side = 0);
  std::optional<Typed> other_than_sum(ast::Expression const& tree);
  std::optional<Typed> binary(ast::Binary const& binary);
  Typed combined(ast::Binary const& binary, Typed const& left, Typed const& right);
  Typed compared(Operation operation, UnitOperand left, UnitOperand right);
  std::optional<Typed> function_call(ast::Call const& call);
  struct CallArguments {
    std::vector<UnitOperand> values;
    std::size_t count = 0;  // as written
    bool counted = true;    // unless a list of lags is wrong, or a range stands for several arguments
    bool good = true;
  };
  CallArguments call_arguments(ast::Call const& call);
  // Of a function of the user's: its expression with the arguments in place of its parameters.
  std::optional<Typed> user_call(ast::Call const& call, ast::FunctionDefinition const& function, CallArguments const& arguments);
  Typed built_in(FunctionRow const& row, std::span<UnitOperand const> arguments);
  std::optional<Typed> choice(ast::Conditional const& conditional);

  std::optional<Typed> agreeing_with(std::optional<Unit> const& unit, Span place, ast::Expression const& tree,
                                     Occasion const& occasion);

  std::optional<Diagnostic> sample_in_parentheses(ast::Call const& call) const;

  // lags.cpp
  bool is_lag_call(ast::Call const& call) const;
  std::optional<Typed> lag_call(ast::Call const& call);
  struct Lags {
    int first;
    std::vector<Typed> values;  // first, first + 1, ...
  };
  std::optional<Lags> lag_calls(ast::Call const& call);
  std::optional<int> lag_count(ast::Expression const& tree);
  std::optional<Typed> channel_call(ast::Call const& call);
  std::optional<Typed> change_call(ast::Call const& call);

  // process_call.cpp
  std::optional<Typed> process_call(ast::Call const& call, std::size_t index);
  std::optional<Typed> expansion_call(ast::Call const& call, std::size_t index, std::vector<std::vector<int>> const& columns,
                                      std::vector<Typed> const& given, Process process);

  /// False when expanding functions and definitions takes more work or stack than can be spent.
  bool affordable(Span span);

  using Arguments = std::map<std::string, Typed>;  // names that hide the others while a function is expanded
  Graph& graph_;
  Diagnostics& diagnostics_;
  std::map<std::string, Symbol> symbols_;
  std::map<std::string, ast::FunctionDefinition const*> functions_;
  std::vector<ProcessName> processes_;
  std::map<ast::Definition const*, std::optional<Typed>> resolved_;
  std::vector<std::string> resolving_;
  std::size_t expressions_ = 0, depth_ = 0;  // expressions so far; those being looked at, one inside the other
  bool too_large_ = false;                   // and said so
  Arguments const* arguments_ = nullptr;
  UnitCheck units_;
  SampleNames samples_;
};

/// y, y', y'', ... as text.
std::string primed_name(std::string const& name, int primes);
/// unit(y)/s^primes, absent where y has none.
std::optional<Unit> rate_unit(std::optional<Unit> const& unit, int primes);

}  // namespace sysid
