// A Gaussian process where it is applied: its covariance from the declaration, with the units that its arguments bring.
#include <algorithm>
#include <map>
#include <utility>

#include "check/errors.hpp"
#include "check/model_checker.hpp"
#include "check/scope.hpp"
#include "check/units.hpp"
#include "gaussian_process/kernel.hpp"

namespace sysid {
namespace {

using gaussian_process::HyperParameterRow;
using gaussian_process::KernelRow;

/// A hyper-parameter as given: of which kernel, for which column.
struct GivenHyperParameter {
  HyperParameterRow const* row;
  int column;  // of the process's inputs; -1: of none
  Typed value;
};

/// What is known of the units of a process, as more of its hyper-parameters are looked at.
struct KnownUnits {
  std::vector<std::optional<Unit>> columns;
  std::optional<Unit> output, own;
};

std::optional<Unit> known_unit(Typed const& value) {
  return value.kind == Typed::Kind::known ? std::optional(value.unit) : std::nullopt;
}

/// output^a * input^b * own^c, where all that take part are known.
std::optional<Unit> product(KnownUnits const& known, GivenHyperParameter const& given) {
  Unit result;
  auto const take = [&](std::optional<Unit> const& unit, int exponent) {
    if (exponent == 0) return true;
    if (!unit) return false;
    result = multiply(result, power(*unit, {exponent, 1}));
    return true;
  };
  auto const& input = given.column < 0 ? std::nullopt : known.columns[static_cast<std::size_t>(given.column)];
  if (!take(known.output, given.row->unit.output) || !take(input, given.row->unit.input) || !take(known.own, given.row->unit.own))
    return std::nullopt;
  return result;
}

/// Finds the one unit that a hyper-parameter of known unit still leaves open; false where it finds none.
bool learn(KnownUnits& known, GivenHyperParameter const& given) {
  auto const unit = known_unit(given.value);
  if (!unit) return false;
  struct Part {
    std::optional<Unit>* unit;
    int exponent;
  };
  std::optional<Unit> none;
  std::optional<Unit>* const input = given.column < 0 ? &none : &known.columns[static_cast<std::size_t>(given.column)];
  std::vector<Part> open;
  Unit rest = *unit;
  for (Part const part :
       {Part{&known.output, given.row->unit.output}, Part{input, given.row->unit.input}, Part{&known.own, given.row->unit.own}}) {
    if (part.exponent == 0) continue;
    if (*part.unit)
      rest = divide(rest, power(**part.unit, {part.exponent, 1}));
    else
      open.push_back(part);
  }
  if (open.size() != 1) return false;
  *open.front().unit = open.front().exponent == 1 ? rest : power(rest, {1, open.front().exponent});
  return true;
}

class CovarianceReader {
 public:
  CovarianceReader(Scope& scope, ast::ProcessDefinition const& definition, Process& process,
                   std::vector<std::vector<int>> const& columns)
      : scope_(scope), definition_(definition), process_(process), columns_(columns) {}

  bool read() {
    ast::Call const& call = definition_.process;
    if (call.function.text != "gp") return refuse(errors::not_a_process(call.function));
    if (call.arguments.size() != 1 || call.arguments.front().name) return refuse(errors::one_covariance(call.span));
    return covariance(call.arguments.front().value);
  }
  std::vector<std::vector<GivenHyperParameter>> const& given() const { return given_; }

 private:
  bool refuse(Diagnostic diagnostic) {
    scope_.diagnostics().add(std::move(diagnostic));
    return false;
  }

  bool covariance(ast::Expression const& tree) {
    if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
        binary != nullptr && ((*binary)->symbol == "+" || (*binary)->symbol == "*")) {
      if (!covariance(*(*binary)->left)) return false;
      int const left = static_cast<int>(process_.covariance.size()) - 1;
      if (!covariance(*(*binary)->right)) return false;
      int const right = static_cast<int>(process_.covariance.size()) - 1;
      auto const kind = (*binary)->symbol == "+" ? Process::Covariance::Kind::sum : Process::Covariance::Kind::product;
      process_.covariance.push_back({kind, left, right});
      return true;
    }
    auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node);
    return call != nullptr ? kernel(**call) : refuse(errors::not_a_covariance(tree.span));
  }

  bool kernel(ast::Call const& call) {
    KernelUse use;
    use.row = gaussian_process::find_kernel(call.function.text);
    if (use.row == nullptr) {
      std::vector<std::string> known;
      for (KernelRow const& each : gaussian_process::kernels()) known.emplace_back(each.name);
      return refuse(errors::unknown_kernel(call.function, known));
    }
    std::map<std::string, ast::Argument const*> named;
    std::vector<int> inputs;  // as declared
    for (ast::Argument const& argument : call.arguments) {
      if (!argument.name) {
        int const input = input_of(argument.value);
        if (input < 0) return false;
        if (std::find(inputs.begin(), inputs.end(), input) != inputs.end())
          return refuse(errors::kernel_input_twice(argument.span, definition_.inputs[static_cast<std::size_t>(input)].text));
        inputs.push_back(input);
      } else if (auto const [place, fresh] = named.emplace(argument.name->text, &argument); !fresh) {
        return refuse(errors::argument_twice(argument.span, place->second->span, argument.name->text, argument.name->text));
      }
    }
    if (inputs.empty())
      for (int i = 0; i < static_cast<int>(definition_.inputs.size()); ++i) inputs.push_back(i);
    for (int const input : inputs)
      use.inputs.insert(use.inputs.end(), columns_[static_cast<std::size_t>(input)].begin(),
                        columns_[static_cast<std::size_t>(input)].end());
    if (use.row->one_input && use.inputs.size() != 1)
      return refuse(errors::kernel_of_one_input(call.span, call.function.text, use.inputs.size()));
    given_.emplace_back();
    if (!hyper_parameters(call, inputs, named, use)) return false;
    process_.covariance.push_back({Process::Covariance::Kind::kernel, static_cast<int>(process_.kernels.size()), 0});
    process_.kernels.push_back(std::move(use));
    return true;
  }

  int input_of(ast::Expression const& tree) {
    auto const* reference = std::get_if<ast::Reference>(&tree.node);
    std::vector<std::string> known;
    for (std::size_t i = 0; i < definition_.inputs.size(); ++i) {
      if (reference != nullptr && reference->primes == 0 && reference->index.empty() &&
          reference->name.text == definition_.inputs[i].text)
        return static_cast<int>(i);
      known.push_back(definition_.inputs[i].text);
    }
    refuse(errors::not_an_input_of_process(tree.span, reference == nullptr ? std::string() : reference->name.text,
                                           definition_.name.text, known));
    return -1;
  }

  bool hyper_parameters(ast::Call const& call, std::vector<int> const& inputs, std::map<std::string, ast::Argument const*>& named,
                        KernelUse const& use) {
    std::vector<std::string> known;
    for (HyperParameterRow const& row : use.row->hyper_parameters) known.emplace_back(row.name);
    for (auto const& [name, argument] : named)
      if (std::find(known.begin(), known.end(), name) == known.end())
        return refuse(errors::unknown_argument(*argument->name, call.function.text, known));
    for (HyperParameterRow const& row : use.row->hyper_parameters) {
      auto const found = named.find(std::string(row.name));
      if (found == named.end()) return refuse(errors::argument_missing(call, {std::string(row.name)}));
      ast::Expression const& tree = found->second->value;
      if (!row.per_input) {
        if (!add(row, use.inputs.size() == 1 ? use.inputs.front() : -1, tree)) return false;
        continue;
      }
      // One for each declared input; of an input that stands for several lags one for all of them, or a list.
      auto const* list = std::get_if<ast::Box<ast::List>>(&tree.node);
      if (list == nullptr) {
        for (int const column : use.inputs)
          if (!add(row, column, tree)) return false;
        continue;
      }
      bool const of_columns = inputs.size() == 1;  // `length = lu` of a vector lu
      std::size_t const wanted = of_columns ? use.inputs.size() : inputs.size();
      if ((*list)->items.size() != wanted)
        return refuse(errors::hyper_parameter_count(tree.span, std::string(row.name), (*list)->items.size(), wanted));
      for (std::size_t i = 0; i < wanted; ++i) {
        ast::Expression const& item = (*list)->items[i];
        if (of_columns) {
          if (!add(row, use.inputs[i], item)) return false;
          continue;
        }
        std::vector<int> const& columns = columns_[static_cast<std::size_t>(inputs[i])];
        auto const* inner = std::get_if<ast::Box<ast::List>>(&item.node);
        if (inner != nullptr && (*inner)->items.size() != columns.size())
          return refuse(errors::hyper_parameter_count(item.span, std::string(row.name), (*inner)->items.size(), columns.size()));
        for (std::size_t k = 0; k < columns.size(); ++k)
          if (!add(row, columns[k], inner == nullptr ? item : (*inner)->items[k])) return false;
      }
    }
    return true;
  }

  bool add(HyperParameterRow const& row, int column, ast::Expression const& tree) {
    auto const value = scope_.expression(tree);
    if (!value) return false;
    Graph const& graph = scope_.graph();
    std::string const name(row.name);
    if (std::string const what = moving_part(graph, value->node); !what.empty())
      return refuse(errors::hyper_parameter_moves(tree.span, name, what));
    if (auto const number = graph.constant_value(value->node); number && !(*number > 0))
      return refuse(errors::hyper_parameter_not_positive(tree.span, name));
    given_.back().push_back({&row, column, settled(*value)});
    given_.back().back().value.span = tree.span;
    given_.back().back().value.unit.offset = 0;  // a length along a scale of temperatures is a difference of two
    return true;
  }

  Scope& scope_;
  ast::ProcessDefinition const& definition_;
  Process& process_;
  std::vector<std::vector<int>> const& columns_;
  std::vector<std::vector<GivenHyperParameter>> given_;  // by kernel
};

/// Units of columns and of the process's values; hyper-parameters in SI. False after a diagnostic.
bool settle_units(Scope& scope, ast::ProcessDefinition const& definition,
                  std::vector<std::vector<GivenHyperParameter>> const& given, std::vector<std::optional<Unit>> const& arguments,
                  Process& process) {
  std::vector<std::optional<Unit>> outputs;
  for (std::size_t k = 0; k < given.size(); ++k) {
    KnownUnits known{arguments, {}, {}};
    // What has no unit of its own takes the one that the hyper-parameters leave it.
    for (std::size_t round = 0; round <= given[k].size(); ++round)
      if (std::none_of(given[k].begin(), given[k].end(), [&](GivenHyperParameter const& each) { return learn(known, each); }))
        break;
    for (GivenHyperParameter const& each : given[k]) {
      auto const wanted = product(known, each);
      auto const unit = known_unit(each.value);
      if (wanted && unit && wanted->dimension != unit->dimension) {
        Quantity const none, &input = each.column < 0 ? none : process.inputs[static_cast<std::size_t>(each.column)];
        auto const of_input = each.column < 0 ? std::nullopt : arguments[static_cast<std::size_t>(each.column)];
        scope.diagnostics().add(errors::hyper_parameter_unit(each.value.span, std::string(each.row->name), input.name, *unit,
                                                             *wanted, input.span, of_input));
        return false;
      }
      process.kernels[k].hyper_parameters.push_back(adapt(scope.graph(), each.value, wanted));
    }
    outputs.push_back(known.output);
  }
  // Kernels that are added share the unit of their values; of those multiplied the units are multiplied.
  std::vector<std::optional<Unit>> units;
  for (Process::Covariance const& each : process.covariance) {
    auto const left = static_cast<std::size_t>(each.left), right = static_cast<std::size_t>(each.right);
    if (each.kind == Process::Covariance::Kind::kernel) {
      units.push_back(outputs[left]);
    } else if (each.kind == Process::Covariance::Kind::product) {
      units.push_back(units[left] && units[right] ? std::optional(multiply(*units[left], *units[right])) : std::nullopt);
    } else {
      if (units[left] && units[right] && units[left]->dimension != units[right]->dimension) {
        scope.diagnostics().add(errors::kernels_of_other_units(definition.process.span, *units[left], *units[right]));
        return false;
      }
      units.push_back(units[left] ? units[left] : units[right]);
    }
  }
  process.unit = units.back();
  return true;
}

}  // namespace

bool Scope::define_process(ast::ProcessDefinition const& process) {
  for (ProcessName const& each : processes_)
    if (each.definition->name.text == process.name.text) {
      diagnostics_.add(errors::duplicate_name(process.name, each.definition->name.span));
      return false;
    }
  if (auto const place = functions_.find(process.name.text); place != functions_.end()) {
    diagnostics_.add(errors::duplicate_name(process.name, place->second->name.span));
    return false;
  }
  processes_.push_back({&process, {}, {}});
  return true;
}

std::optional<Typed> Scope::process_call(ast::Call const& call, std::size_t index) {
  ast::ProcessDefinition const& definition = *processes_[index].definition;
  std::string const& name = definition.name.text;
  if (samples_.in_equation && !samples_.discrete) {
    diagnostics_.add(errors::process_in_differential_equation(call.span, name));
    return std::nullopt;
  }
  if (call.arguments.size() != definition.inputs.size()) {
    diagnostics_.add(
        errors::argument_count(call.function, call.arguments.size(), definition.inputs.size(), definition.inputs.size()));
    return std::nullopt;
  }
  Process process;
  process.name = name;
  process.span = definition.name.span;
  std::vector<std::vector<int>> columns;
  std::vector<std::optional<Unit>> units;
  bool good = true;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    ast::Argument const& argument = call.arguments[i];
    if (argument.name) {
      diagnostics_.add(errors::named_argument_of_function(*argument.name, name));
      return std::nullopt;
    }
    std::vector<Typed> values;
    auto const* inner = std::get_if<ast::Box<ast::Call>>(&argument.value.node);
    if (inner != nullptr && (*inner)->function.text == "lags" && is_past_call(**inner)) {
      auto lags = lag_calls(**inner);
      if (lags) values = std::move(*lags);
    } else if (auto const value = expression(argument.value)) {
      values.push_back(settled(*value));
    }
    good = good && !values.empty();
    columns.emplace_back();
    for (Typed const& value : values) {
      columns.back().push_back(static_cast<int>(process.inputs.size()));
      process.inputs.push_back({definition.inputs[i].text, known_unit(value), argument.span});
      process.arguments.push_back(value.node);
      units.push_back(known_unit(value));
      if (units.back()) units.back() = difference(*units.back());
    }
  }
  if (!good) return std::nullopt;
  for (NodeId const argument : process.arguments)
    if (graph_.depends(argument, [](Node const& node) { return is_leaf(node, LeafKind::process); })) {
      diagnostics_.add(errors::process_out_of_place(call.span, "the argument of another"));
      return std::nullopt;
    }
  NodeId const leaf = graph_.leaf(LeafKind::process, static_cast<int>(index));
  if (processes_[index].use) {
    if (processes_[index].use->arguments != process.arguments) {
      diagnostics_.add(errors::process_applied_twice(call.span, processes_[index].call, name));
      return std::nullopt;
    }
    return with_unit(leaf, processes_[index].use->unit, call.span);
  }
  // Its declaration means the model's names, wherever it is applied.
  auto const* outer = std::exchange(arguments_, nullptr);
  auto calls = units_.suspend();
  CovarianceReader reader(*this, definition, process, columns);
  good = reader.read() && settle_units(*this, definition, reader.given(), units, process);
  units_.resume(std::move(calls));
  arguments_ = outer;
  if (!good) return std::nullopt;
  Typed const value = with_unit(leaf, process.unit, call.span);
  processes_[index].use = std::move(process);
  processes_[index].call = call.span;
  return value;
}

}  // namespace sysid
