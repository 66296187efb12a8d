// Reads `within` and `terms`, and builds the finite sum with a coefficient for every term.
#include "check/process/process_expansion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "check/elaborate/whole_number.hpp"
#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"
#include "expression/term.hpp"
#include "gaussian_process/basis.hpp"

namespace sysid {
namespace {

// Twice the range: where a function is wanted, a process that is zero at the faces of its box should not feel them.
constexpr double box_over_range = 2;
constexpr long most_coefficients = 400;

ast::Argument const* named(ast::ProcessDefinition const& definition, std::string_view name) {
  for (ast::Argument const& argument : definition.process.arguments)
    if (argument.name && argument.name->text == name) return &argument;
  return nullptr;
}

/// How many functions along each input; empty where `terms` says nothing that can be read.
std::vector<int> counts_of(ast::ProcessDefinition const& definition) {
  std::size_t const inputs = definition.inputs.size();
  ast::Argument const* terms = named(definition, "terms");
  if (terms == nullptr) return std::vector<int>(inputs, inputs == 1 ? 16 : inputs == 2 ? 8 : 5);
  auto const number = [](ast::Expression const& tree) {
    auto const value = whole_number(tree, {});
    return value && *value > 0 && *value <= most_coefficients ? static_cast<int>(*value) : 0;
  };
  std::vector<int> counts;
  if (auto const* list = std::get_if<ast::Box<ast::List>>(&terms->value.node))
    for (ast::Expression const& item : (*list)->items) counts.push_back(number(item));
  else
    counts.assign(inputs, number(terms->value));
  if (counts.size() != inputs || std::count(counts.begin(), counts.end(), 0) > 0) counts.clear();
  return counts;
}

/// Functions of all kernels of a sum; 0 where it is no sum of kernels that have an expansion.
long size_of(ast::Expression const& tree, ast::ProcessDefinition const& definition, std::vector<int> const& counts) {
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node); binary != nullptr && (*binary)->symbol == "+") {
    long const left = size_of(*(*binary)->left, definition, counts), right = size_of(*(*binary)->right, definition, counts);
    return left == 0 || right == 0 ? 0 : left + right;
  }
  auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node);
  if (call == nullptr) return 0;
  auto const* row = gaussian_process::find_kernel((*call)->function.text);
  if (row == nullptr || !gaussian_process::has_expansion(*row)) return 0;
  std::vector<int> own;
  for (ast::Argument const& argument : (*call)->arguments) {
    if (argument.name) continue;
    auto const* reference = std::get_if<ast::Reference>(&argument.value.node);
    for (std::size_t i = 0; i < definition.inputs.size(); ++i)
      if (reference != nullptr && reference->name.text == definition.inputs[i].text) own.push_back(counts[i]);
  }
  return gaussian_process::expansion_size(*row, own.empty() ? counts : own);
}

class Expander {
 public:
  Expander(Scope& scope, ast::ProcessDefinition const& definition, Process process)
      : scope_(scope), graph_(scope.graph()), definition_(definition) {
    static_cast<Quantity&>(expansion_) = process;
    expansion_.process = std::move(process);
  }

  std::optional<Expansion> run(ProcessArguments const& arguments, std::vector<int> coefficients) {
    auto const terms = arguments.named.find("terms");
    box_.counts = counts_of(definition_);
    if (box_.counts.empty()) return refuse(errors::expansion_terms(terms->second->value.span, definition_.inputs.size()));
    auto const within = arguments.named.find("within");
    if (within == arguments.named.end()) return refuse(errors::expansion_without_range(terms->second->span));
    if (!ranges(within->second->value)) return std::nullopt;
    for (ProcessCondition const& condition : expansion_.process.conditions)
      for (std::size_t d = 0; d < condition.point.size(); ++d)
        if (condition.point[d] < expansion_.inputs[d].low || condition.point[d] > expansion_.inputs[d].high)
          return refuse(errors::expansion_condition_outside(within->second->value.span, definition_.inputs[d].text));
    for (Process::Covariance const& each : expansion_.process.covariance)
      if (each.kind == Process::Covariance::Kind::product)
        return refuse(errors::no_expansion(arguments.covariance->span, "a product of kernels"));
    for (KernelUse const& kernel : expansion_.process.kernels)
      if (!gaussian_process::has_expansion(*kernel.row))
        return refuse(errors::no_expansion(arguments.covariance->span, std::string(kernel.row->name)));
    if (coefficients.empty())
      return refuse(errors::expansion_too_large(terms == arguments.named.end() ? within->second->span : terms->second->span,
                                                most_coefficients));
    expansion_.coefficients = std::move(coefficients);
    std::vector<ProcessCondition> const conditions = independent_conditions();
    if (conditions.size() >= expansion_.coefficients.size())
      return refuse(errors::expansion_too_small(terms == arguments.named.end() ? within->second->span : terms->second->span,
                                                conditions.size()));
    value(conditions);
    return std::move(expansion_);
  }

 private:
  std::nullopt_t refuse(Diagnostic diagnostic) {
    scope_.diagnostics().add(std::move(diagnostic));
    return std::nullopt;
  }

  /// `(low, high)` of one input, a list of such pairs of several.
  bool ranges(ast::Expression const& tree) {
    std::size_t const inputs = definition_.inputs.size();
    auto const* list = std::get_if<ast::Box<ast::List>>(&tree.node);
    if (list == nullptr || (inputs > 1 && (*list)->items.size() != inputs)) {
      refuse(errors::expansion_range(tree.span, inputs));
      return false;
    }
    for (std::size_t i = 0; i < inputs; ++i)
      if (!range(inputs == 1 ? tree : (*list)->items[i], expansion_.process.inputs[i])) return false;
    return true;
  }

  bool range(ast::Expression const& tree, Quantity const& input) {
    auto const* pair = std::get_if<ast::Box<ast::List>>(&tree.node);
    if (pair == nullptr || (*pair)->items.size() != 2) {
      refuse(errors::expansion_range(tree.span, definition_.inputs.size()));
      return false;
    }
    double bound[2] = {};
    for (std::size_t end = 0; end < 2; ++end) {
      ast::Expression const& item = (*pair)->items[end];
      auto const given = scope_.expression_in(input.unit, input.span, item, {Occasion::Kind::declared, input.name});
      if (!given) return false;
      auto const number = graph_.constant_value(adapt(graph_, *given, input.unit));
      if (!number || !std::isfinite(*number)) {
        refuse(errors::constant_needed(item.span, {"an end of the range of a function"}));
        return false;
      }
      bound[end] = *number;
    }
    if (!(bound[0] < bound[1])) {
      refuse(errors::expansion_range_empty(tree.span));
      return false;
    }
    Expansion::Input one;
    static_cast<Quantity&>(one) = input;
    one.low = bound[0], one.high = bound[1];
    expansion_.inputs.push_back(std::move(one));
    box_.centre.push_back(0.5 * (bound[0] + bound[1]));
    box_.half_widths.push_back(0.5 * box_over_range * (bound[1] - bound[0]));
    return true;
  }

  /// The sum over kernels in terms of some coefficients, which need not be leaves.
  NodeId sum(std::vector<NodeId> const& coefficients, std::vector<KernelUse> const& kernels) {
    std::vector<NodeId> terms;
    std::span<NodeId const> rest(coefficients);
    for (KernelUse const& kernel : kernels) {
      gaussian_process::Box own;
      std::vector<NodeId> inputs;
      for (int const input : kernel.inputs) {
        auto const i = static_cast<std::size_t>(input);
        own.centre.push_back(box_.centre[i]);
        own.half_widths.push_back(box_.half_widths[i]);
        own.counts.push_back(box_.counts[i]);
        inputs.push_back(Expansion::argument(graph_, input));
      }
      auto const size = static_cast<std::size_t>(gaussian_process::expansion_size(*kernel.row, own.counts));
      terms.push_back(gaussian_process::expansion(*kernel.row, graph_, kernel.hyper_parameters, inputs, rest.first(size), own));
      rest = rest.subspan(size);
    }
    NodeId total = terms.front();
    for (std::size_t k = 1; k < terms.size(); ++k) total = graph_.add(total, terms[k]);
    return total;
  }

  /// What a condition asks of the coefficients: the factor of each in the value, or the slope, that is to vanish.
  std::vector<Term> functional(ProcessCondition const& condition, std::vector<KernelUse> const& kernels) {
    std::vector<Term> factors;
    std::vector<NodeId> one(expansion_.coefficients.size(), graph_.constant(0));
    for (NodeId& coefficient : one) {
      coefficient = graph_.constant(1);
      NodeId factor = sum(one, kernels);
      coefficient = graph_.constant(0);
      if (condition.derivative >= 0) factor = graph_.differentiate(factor, Expansion::argument(graph_, condition.derivative));
      factors.emplace_back(graph_, graph_.substitute(factor, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph_[leaf];
        if (node.leaf_kind != LeafKind::unknown) return std::nullopt;
        return graph_.constant(condition.point[static_cast<std::size_t>(-1 - node.index)]);
      }));
    }
    return factors;
  }

  /// The kernels with numbers in place of hyper-parameters, lengths so short that no term vanishes: what depends on what among
  /// conditions is the same for all positive ones.
  std::vector<KernelUse> with_numbers() {
    std::vector<KernelUse> kernels = expansion_.process.kernels;
    for (KernelUse& kernel : kernels) {
      std::size_t k = 0;
      for (gaussian_process::HyperParameterRow const& row : kernel.row->hyper_parameters)
        for (std::size_t d = 0; d < (row.per_input ? kernel.inputs.size() : 1); ++d) {
          auto const input = static_cast<std::size_t>(kernel.inputs[d]);
          double const length = box_.half_widths[input] / box_.counts[input];
          kernel.hyper_parameters[k++] = graph_.constant(row.per_input && row.unit.input == 1 ? length : 1);
        }
    }
    return kernels;
  }

  /// Without those that the others imply: the same point twice, a line through the origin that shall vanish there.
  std::vector<ProcessCondition> independent_conditions() {
    std::vector<KernelUse> const kernels = with_numbers();
    std::vector<ProcessCondition> kept;
    std::vector<std::vector<double>> directions;
    for (ProcessCondition const& condition : expansion_.process.conditions) {
      std::vector<double> direction;
      for (Term const factor : functional(condition, kernels)) direction.push_back(graph_.constant_value(factor.id).value());
      auto const dot = [](std::vector<double> const& a, std::vector<double> const& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
      };
      double const whole = std::sqrt(dot(direction, direction));
      for (std::vector<double> const& before : directions) {
        double const part = dot(before, direction);
        for (std::size_t j = 0; j < direction.size(); ++j) direction[j] -= part * before[j];
      }
      double const rest = std::sqrt(dot(direction, direction));
      if (!(rest > 1e-8 * whole)) continue;
      for (double& factor : direction) factor /= rest;
      directions.push_back(std::move(direction));
      kept.push_back(condition);
    }
    return kept;
  }

  /// The sum of its coefficients where conditions hold: independent normal numbers given that linear functionals of them vanish are
  /// such numbers without their parts along the functionals, made orthonormal one after another.
  void value(std::vector<ProcessCondition> const& conditions) {
    auto const dot = [&](std::vector<Term> const& a, std::vector<Term> const& b) {
      Term total(graph_, 0.0);
      for (std::size_t j = 0; j < a.size(); ++j) total = total + a[j] * b[j];
      return total;
    };
    auto const without = [&](std::vector<Term> vector, std::vector<Term> const& direction) {
      Term const part = dot(direction, vector);
      for (std::size_t j = 0; j < vector.size(); ++j) vector[j] = vector[j] - part * direction[j];
      return vector;
    };
    std::vector<Term> coefficients;
    for (int const parameter : expansion_.coefficients)
      coefficients.emplace_back(graph_, graph_.leaf(LeafKind::parameter, parameter));
    std::vector<std::vector<Term>> directions;
    for (ProcessCondition const& condition : conditions) {
      std::vector<Term> direction = functional(condition, expansion_.process.kernels);
      for (std::vector<Term> const& before : directions) direction = without(std::move(direction), before);
      // A length far beyond the range makes a function that is next to nothing: what underflows there takes nothing away.
      Term const length = sqrt(dot(direction, direction) + 1e-300);
      for (Term& factor : direction) factor = factor / length;
      directions.push_back(std::move(direction));
    }
    for (std::vector<Term> const& direction : directions) coefficients = without(std::move(coefficients), direction);
    std::vector<NodeId> nodes;
    for (Term const coefficient : coefficients) nodes.push_back(coefficient.id);
    expansion_.value = sum(nodes, expansion_.process.kernels);
  }

  Scope& scope_;
  Graph& graph_;
  ast::ProcessDefinition const& definition_;
  Expansion expansion_;
  gaussian_process::Box box_;
};

}  // namespace

bool is_expanded(ast::ProcessDefinition const& definition) {
  return named(definition, "within") != nullptr || named(definition, "terms") != nullptr;
}

int coefficient_count(ast::ProcessDefinition const& definition) {
  std::vector<int> const counts = counts_of(definition);
  if (counts.empty()) return 0;
  double product = 1;  // before it is one of whole numbers
  for (int const count : counts) product *= count;
  if (product > most_coefficients) return 0;
  for (ast::Argument const& argument : definition.process.arguments)
    if (!argument.name)
      if (long const size = size_of(argument.value, definition, counts); size <= most_coefficients) return static_cast<int>(size);
  return 0;
}

std::optional<Expansion> expand(Scope& scope, ast::ProcessDefinition const& definition, ProcessArguments const& arguments,
                                Process process, std::vector<int> coefficients) {
  return Expander(scope, definition, std::move(process)).run(arguments, std::move(coefficients));
}

}  // namespace sysid
